"""Train and test one pipeline on the touches of one strategy."""

from visuohaptic.recognition.files import make_scores
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_scores(
        features=snakemake.input.features,
        scores=snakemake.output.scores,
        predictions=snakemake.output.predictions,
        pipeline=snakemake.wildcards.pipeline,
        strategy=snakemake.wildcards.strategy,
        parameters=RecognitionParameters(**snakemake.params.recognition),
        seed=snakemake.params.seed,
    )
