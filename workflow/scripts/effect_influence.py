"""Measure what each effect costs, and how far it moves images."""

from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.geometry.surface import meshes_in
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.studies.effects.influence import make_effect_influence
from visuohaptic.touches.choosing import Wanted
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_effect_influence(
        meshes=meshes_in(snakemake.input.meshes, snakemake.params.sample),
        fixations=snakemake.input.fixations,
        output=snakemake.output[0],
        viewpoints=ViewpointParameters(**snakemake.params.viewpoints),
        rendering=RenderingParameters(**snakemake.params.rendering),
        sensor=SensorParameters(**snakemake.params.sensor),
        scene=Scene(**snakemake.params.scene),
        seed=snakemake.params.seed,
        wanted=Wanted(**snakemake.params.wanted),
    )
