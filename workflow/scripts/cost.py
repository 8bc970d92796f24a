"""Weigh accuracy against time, and mark the front."""

from visuohaptic.cost.making import make_cost
from visuohaptic.jobs import logged_job

with logged_job(snakemake.log[0]):
    make_cost(
        errors=snakemake.input.errors,
        seconds=snakemake.input.seconds,
        output=snakemake.output.cost,
        metrics=snakemake.output.metrics,
    )
