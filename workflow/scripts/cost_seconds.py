"""Time every setting side by side."""

from visuohaptic.cost.making import make_cost_seconds
from visuohaptic.jobs import logged_job
from visuohaptic.parameters import ExperimentParameters

with logged_job(snakemake.log[0]):
    make_cost_seconds(
        meshes=snakemake.input.meshes,
        described=dict(zip(snakemake.params.families, snakemake.input.described, strict=True)),
        output=snakemake.output[0],
        parameters=ExperimentParameters.from_mapping(snakemake.params.parameters),
    )
