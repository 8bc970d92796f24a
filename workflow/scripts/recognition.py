"""Train and test one pipeline on the touches of one strategy."""

from visuohaptic.jobs import logged_job
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.scores import make_scores

with logged_job(snakemake.log[0]):
    make_scores(
        features=snakemake.input.features,
        scores=snakemake.output.scores,
        predictions=snakemake.output.predictions,
        pipeline=snakemake.wildcards.pipeline,
        strategy=snakemake.wildcards.strategy,
        parameters=RecognitionParameters(**snakemake.params.recognition),
        seed=snakemake.params.seed,
    )
