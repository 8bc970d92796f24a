"""Take a block of objects from the mesh to the features."""

from visuohaptic_workflow.jobs import job
from visuohaptic_workflow.object_blocks import run_block

with job(snakemake):
    run_block(
        rules=snakemake.params.rules,
        jobs=snakemake.params.jobs,
        lists=snakemake.output.lists,
    )
