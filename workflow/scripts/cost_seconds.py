"""Time every setting side by side."""

from visuohaptic.geometry.surface import meshes_in
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.cost.files import make_cost_seconds
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_cost_seconds(
        study=snakemake.params.study,
        meshes=list(meshes_in(snakemake.input.meshes, snakemake.params.timed).values()),
        features=snakemake.input.features,
        made=dict(zip(snakemake.params.remade, snakemake.input.made, strict=True)),
        output=snakemake.output[0],
        run=ExperimentParameters.from_mapping(snakemake.params.parameters),
        objects=snakemake.params.sample,
    )
