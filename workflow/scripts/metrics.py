"""Sum up the scores of all pipelines and strategies, and guard the sums."""

from visuohaptic.guards.figures import make_guards
from visuohaptic.recognition.metrics import make_metrics
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_metrics(
        scores=snakemake.input.scores,
        predictions=snakemake.input.predictions,
        metrics=snakemake.output.metrics,
        headline=snakemake.output.headline,
        accuracy=snakemake.output.accuracy,
        confusion=snakemake.output.confusion,
        intervals=IntervalParameters(**snakemake.params.intervals),
        seed=snakemake.params.seed,
        parameters=snakemake.params.parameters,
    )
    # In the same job: the report waits for both, and another start takes as long as the guards.
    make_guards(
        training=snakemake.input.training,
        predictions=snakemake.input.predictions,
        metrics=snakemake.output.metrics,
        output=snakemake.output.guards,
        seed=snakemake.params.seed,
    )
