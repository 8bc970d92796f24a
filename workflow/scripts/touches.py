"""Touch a block of objects where a block of viewpoints looked, and where policies choose to."""

from visuohaptic.touches.acquiring import acquire_touches
from visuohaptic_workflow.jobs import job
from visuohaptic_workflow.phase_jobs import run_block

with job(snakemake):
    run_block(snakemake, acquire_touches)
