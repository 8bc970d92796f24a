"""Touch a block of objects at the probing locations of a block of viewpoints, and where policies choose."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from visuohaptic.touches.acquiring import acquire_touches
from visuohaptic_workflow.jobs import job
from visuohaptic_workflow.phase_jobs import run_block

with job(snakemake):
    run_block(snakemake, acquire_touches)
