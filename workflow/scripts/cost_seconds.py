"""Time every setting side by side."""

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.cost.files import make_cost_seconds
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_cost_seconds(
        meshes=snakemake.input.meshes,
        described=dict(zip(snakemake.params.families, snakemake.input.described, strict=True)),
        output=snakemake.output[0],
        parameters=ExperimentParameters.from_mapping(snakemake.params.parameters),
    )
