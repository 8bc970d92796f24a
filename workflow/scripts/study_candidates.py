"""Touch objects wherever the strategy adaptive may choose to."""

from visuohaptic.geometry.surface import meshes_in
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.curves.adaptive import make_candidates
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_candidates(
        meshes=list(meshes_in(snakemake.input.meshes).values()),
        output=snakemake.output[0],
        parameters=ExperimentParameters.from_mapping(snakemake.params.parameters),
    )
