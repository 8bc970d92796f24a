"""Sum up the curves over touches."""

from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.curves.touches_needed import make_touches_needed
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_touches_needed(
        parts=snakemake.input.parts,
        needed=snakemake.output.needed,
        metrics=snakemake.output.metrics,
        intervals=IntervalParameters(**snakemake.params.intervals),
        seed=snakemake.params.seed,
    )
