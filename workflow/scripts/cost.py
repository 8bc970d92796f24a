"""Weigh accuracy against time, and mark the front."""

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.cost.files import make_cost
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_cost(
        study=snakemake.params.study,
        parts=snakemake.input.parts,
        seconds=snakemake.input.seconds,
        output=snakemake.output[0],
        run=ExperimentParameters.from_mapping(snakemake.params.parameters),
    )
