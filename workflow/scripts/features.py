"""Describe the imprints of one object and a block of viewpoints."""

from visuohaptic.features import FeatureParameters, make_features
from visuohaptic.jobs import logged_job

with logged_job(snakemake.log[0]):
    make_features(
        touches=snakemake.input.touches,
        output=snakemake.output[0],
        parameters=FeatureParameters(**snakemake.params.features),
    )
