"""Measure one reading of the paper."""

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.readings.files import make_reading
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_reading(
        condition=snakemake.params.condition,
        features=snakemake.input.features,
        made=dict(zip(snakemake.params.remade, snakemake.input.made, strict=True)),
        output=snakemake.output[0],
        run=ExperimentParameters.from_mapping(snakemake.params.parameters),
    )
