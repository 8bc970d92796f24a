"""Time every setting side by side."""

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.cost.files import make_cost_seconds
from visuohaptic_workflow.jobs import job
from visuohaptic_workflow.object_blocks import files_of

with job(snakemake):
    make_cost_seconds(
        study=snakemake.params.study,
        meshes=files_of(snakemake.input.meshes, snakemake.params.timed),
        features=files_of(snakemake.input.features, snakemake.params.sample),
        made=dict(zip(snakemake.params.remade, snakemake.input.made, strict=True)),
        output=snakemake.output[0],
        run=ExperimentParameters.from_mapping(snakemake.params.parameters),
    )
