"""End with an error where a guard of the run failed."""

from visuohaptic.guards.verdicts import require_guards
from visuohaptic_workflow.jobs import job

with job(snakemake):
    require_guards(snakemake.input.guards, snakemake.input.report)
