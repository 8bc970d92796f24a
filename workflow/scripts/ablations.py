"""Compare the ablations with the whole method."""

from visuohaptic.ablations import make_ablations
from visuohaptic.jobs import logged_job
from visuohaptic.recognition.parameters import IntervalParameters

with logged_job(snakemake.log[0]):
    make_ablations(
        parts=snakemake.input.parts,
        output=snakemake.output.ablations,
        metrics=snakemake.output.metrics,
        intervals=IntervalParameters(**snakemake.params.intervals),
        seed=snakemake.params.seed,
    )
