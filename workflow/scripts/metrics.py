"""Sum up the scores of all pipelines and strategies."""

from visuohaptic.jobs import logged_job
from visuohaptic.metrics import make_metrics
from visuohaptic.recognition.parameters import IntervalParameters

with logged_job(snakemake.log[0]):
    make_metrics(
        scores=snakemake.input.scores,
        predictions=snakemake.input.predictions,
        metrics=snakemake.output.metrics,
        accuracy=snakemake.output.accuracy,
        confusion=snakemake.output.confusion,
        intervals=IntervalParameters(**snakemake.params.intervals),
        seed=snakemake.params.seed,
    )
