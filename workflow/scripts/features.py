"""Compute features of the imprints of a block of objects and viewpoints."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from visuohaptic.features.describing import describe
from visuohaptic_workflow.jobs import job
from visuohaptic_workflow.phase_jobs import run_block

with job(snakemake):
    run_block(snakemake, describe)
