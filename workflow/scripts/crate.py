"""Pack a finished run as an RO-Crate."""

from visuohaptic_workflow.crate import write_crate
from visuohaptic_workflow.jobs import job

with job(snakemake):
    write_crate(
        archive=snakemake.output[0],
        root=snakemake.params.root,
        results=snakemake.input.results,
        parameters=snakemake.params.parameters,
        commit=snakemake.params.commit,
    )
