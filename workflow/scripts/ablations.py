"""Compare the ablations with the whole method."""

from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.ablations.comparing import make_ablations
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_ablations(
        parts=snakemake.input.parts,
        output=snakemake.output.ablations,
        metrics=snakemake.output.metrics,
        intervals=IntervalParameters(**snakemake.params.intervals),
        seed=snakemake.params.seed,
    )
