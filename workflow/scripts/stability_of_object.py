"""Compute the numerical errors of a block of objects."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.geometry.surface import meshes_in
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.stability.objects import make_object_stability
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_object_stability(
        meshes=meshes_in([snakemake.input.meshes]),
        fixations=snakemake.input.fixations,
        touches=snakemake.input.touches,
        output=snakemake.output[0],
        attention=AttentionParameters(**snakemake.params.attention),
        sensor=SensorParameters(**snakemake.params.sensor),
        scene=Scene(**snakemake.params.scene),
        seed=snakemake.params.seed,
    )
