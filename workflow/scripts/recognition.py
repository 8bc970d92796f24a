"""Train and test a pipeline on the touches of each strategy."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from visuohaptic.recognition.files import make_scores
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic_workflow.jobs import job

with job(snakemake):
    strategies = snakemake.params.strategies
    make_scores(
        features=snakemake.input.features,
        scores=dict(zip(strategies, snakemake.output.scores, strict=True)),
        predictions=dict(zip(strategies, snakemake.output.predictions, strict=True)),
        pipeline=snakemake.wildcards.pipeline,
        parameters=RecognitionParameters(**snakemake.params.recognition),
        seed=snakemake.params.seed,
    )
