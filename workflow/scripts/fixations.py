"""Render views of a block of objects and viewpoints, and compute fixations."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from visuohaptic.fixations.object_views import look
from visuohaptic_workflow.jobs import job
from visuohaptic_workflow.phase_jobs import run_block

with job(snakemake):
    run_block(snakemake, look)
