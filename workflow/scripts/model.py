"""Fit the recognition model on all objects, and write it."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from visuohaptic.recognition.model_of_run import make_model
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_model(
        features=snakemake.input.features,
        model=snakemake.output.model,
        pipeline=snakemake.params.pipeline,
        classifier=snakemake.params.classifier,
        strategies=snakemake.params.strategies,
        recognition=RecognitionParameters(**snakemake.params.recognition),
        touching=snakemake.params.touching,
        seed=snakemake.params.seed,
    )
