"""Sum up the curves over touches."""

from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.curves.touches_needed import make_touches_needed
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_touches_needed(
        curves=snakemake.input.curves,
        points=snakemake.output.points,
        needed=snakemake.output.needed,
        figures=snakemake.output.figures,
        intervals=IntervalParameters(**snakemake.params.intervals),
        seed=snakemake.params.seed,
    )
