"""Measure the error rates of a family of settings."""

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.cost.files import make_cost_errors
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_cost_errors(
        family=snakemake.wildcards.family,
        meshes=snakemake.input.meshes,
        fixations=snakemake.input.fixations,
        features=snakemake.input.features,
        output=snakemake.output.errors,
        described=snakemake.output.described,
        parameters=ExperimentParameters.from_mapping(snakemake.params.parameters),
    )
