"""Look at a block of objects from a block of viewpoints."""

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.fixations.files import make_fixations
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.geometry.surface import meshes_in
from visuohaptic.scene.parameters import EffectModes
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_fixations(
        meshes=meshes_in([snakemake.input.meshes]),
        fixations=snakemake.output.fixations,
        views=snakemake.output.views,
        effects=snakemake.output.effects,
        block=snakemake.params.viewpoints_of_block,
        viewpoints=ViewpointParameters(**snakemake.params.viewpoints),
        rendering=RenderingParameters(**snakemake.params.rendering),
        attention=AttentionParameters(**snakemake.params.attention),
        strategies=snakemake.params.strategies,
        modes=EffectModes(**snakemake.params.modes),
        seed=snakemake.params.seed,
    )
