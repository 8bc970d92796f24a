"""Measure how far each effect moves the accuracy."""

from visuohaptic.features.parameters import FeatureParameters
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.studies.effects.accuracy import make_effect_accuracy
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_effect_accuracy(
        meshes=snakemake.input.meshes,
        fixations=snakemake.input.fixations,
        output=snakemake.output[0],
        sensor=SensorParameters(**snakemake.params.sensor),
        features=FeatureParameters(**snakemake.params.features),
        recognition=RecognitionParameters(**snakemake.params.recognition),
        seed=snakemake.params.seed,
    )
