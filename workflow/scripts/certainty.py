"""Measure prediction sets and the answer `unknown`."""

from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.studies.certainty import make_certainty
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_certainty(
        features=snakemake.input.features,
        table=snakemake.output.table,
        metrics=snakemake.output.metrics,
        strategies=snakemake.params.strategies,
        classifier=snakemake.params.classifier,
        parameters=RecognitionParameters(**snakemake.params.recognition),
        seed=snakemake.params.seed,
    )
