"""Write all touches as a data set that other tools read."""

from pathlib import Path

from visuohaptic.export.experiment import read_experiment
from visuohaptic.export.files import make_export
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_export(
        touches=snakemake.input.touches,
        credit_files=snakemake.input.credits,
        folder=Path(snakemake.output[0]).parent,
        seed=snakemake.params.seed,
        experiment=read_experiment(
            snakemake.input.features,
            snakemake.input.predictions,
            snakemake.input.metrics,
            snakemake.params.parameters,
            snakemake.params.commit,
        ),
    )
