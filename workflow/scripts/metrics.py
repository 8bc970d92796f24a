"""Summarise the scores of all pipelines and strategies."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from visuohaptic.evaluation.metrics import make_metrics
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_metrics(
        scores=snakemake.input.scores,
        predictions=snakemake.input.predictions,
        touches=snakemake.input.touches,
        views=snakemake.input.views,
        metrics=snakemake.output.metrics,
        accuracy=snakemake.output.accuracy,
        confusion=snakemake.output.confusion,
        intervals=IntervalParameters(**snakemake.params.intervals),
        fixations=snakemake.params.parameters["attention"]["fixations"],
        parameters=snakemake.params.parameters,
        drawn=snakemake.input.drawn,
    )
