"""Pack a finished run as an RO-Crate."""

from visuohaptic_workflow.crate import write_crate
from visuohaptic_workflow.jobs import job
from visuohaptic_workflow.object_blocks import files_of

with job(snakemake):
    write_crate(
        archive=snakemake.output[0],
        root=snakemake.params.root,
        results=files_of(snakemake.input.results),
        parameters=snakemake.params.parameters,
        commit=snakemake.params.commit,
    )
