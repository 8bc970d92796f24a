"""Sum up the curves over touches."""

from visuohaptic.jobs import logged_job
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.touches_needed import make_touches_needed

with logged_job(snakemake.log[0]):
    make_touches_needed(
        curves=snakemake.input.curves,
        points=snakemake.output.points,
        needed=snakemake.output.needed,
        figures=snakemake.output.figures,
        intervals=IntervalParameters(**snakemake.params.intervals),
        seed=snakemake.params.seed,
    )
