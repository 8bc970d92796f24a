"""Weigh accuracy against time, and mark the front."""

from visuohaptic.studies.cost.files import make_cost
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_cost(
        errors=snakemake.input.errors,
        seconds=snakemake.input.seconds,
        output=snakemake.output.cost,
        metrics=snakemake.output.metrics,
    )
