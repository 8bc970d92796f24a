"""Try hard cases with known answers."""

from visuohaptic.stability.files import make_stability
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_stability(output=snakemake.output[0], seed=snakemake.params.seed)
