"""Touch a block of objects at the probing locations of a block of viewpoints."""

from visuohaptic.geometry.surface import meshes_in
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.touches.choosing import Wanted
from visuohaptic.touches.files import make_touches
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_touches(
        meshes=meshes_in([snakemake.input.meshes]),
        fixations=snakemake.input.fixations,
        touches=snakemake.output.touches,
        effects=snakemake.output.effects,
        sensor=SensorParameters(**snakemake.params.sensor),
        scene=Scene(**snakemake.params.scene),
        seed=snakemake.params.seed,
        wanted=Wanted(**snakemake.params.wanted),
    )
