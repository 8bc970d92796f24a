"""Describe the imprints of a block of objects and a block of viewpoints."""

from visuohaptic.features.files import make_features
from visuohaptic.features.parameters import FeatureParameters
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_features(
        touches=snakemake.input.touches,
        output=snakemake.output[0],
        parameters=FeatureParameters(**snakemake.params.features),
    )
