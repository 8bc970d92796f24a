"""Train and test one pipeline on touches by the strategy adaptive."""

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.curves.adaptive import make_adaptive_rows
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_adaptive_rows(
        candidates=snakemake.input.candidates,
        output=snakemake.output[0],
        pipeline=snakemake.wildcards.pipeline,
        run=ExperimentParameters.from_mapping(snakemake.params.parameters),
    )
