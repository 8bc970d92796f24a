"""Train and test one pipeline with 1, 2 and more touches by one strategy."""

from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.studies.curves.accuracy import make_curves
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_curves(
        features=snakemake.input.features,
        output=snakemake.output[0],
        pipeline=snakemake.wildcards.pipeline,
        strategy=snakemake.wildcards.strategy,
        parameters=RecognitionParameters(**snakemake.params.recognition),
        focus_radius=snakemake.params.focus_radius,
        touches=snakemake.params.touches,
        seed=snakemake.params.seed,
    )
