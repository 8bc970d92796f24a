"""Measure what each effect costs, and how far it moves images."""

from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.studies.effects.influence import make_effect_influence
from visuohaptic.touches.choosing import Wanted
from visuohaptic_workflow.jobs import job
from visuohaptic_workflow.object_blocks import files_of

with job(snakemake):
    make_effect_influence(
        meshes=files_of(snakemake.input.meshes, snakemake.params.sample),
        fixations=files_of(snakemake.input.fixations, snakemake.params.sampled_fixations),
        output=snakemake.output[0],
        viewpoints=ViewpointParameters(**snakemake.params.viewpoints),
        rendering=RenderingParameters(**snakemake.params.rendering),
        sensor=SensorParameters(**snakemake.params.sensor),
        scene=Scene(**snakemake.params.scene),
        seed=snakemake.params.seed,
        wanted=Wanted(**snakemake.params.wanted),
    )
