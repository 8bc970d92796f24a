"""Touch objects wherever the strategy adaptive may choose to."""

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.curves.adaptive import make_candidates
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_candidates(
        meshes=snakemake.input.meshes,
        output=snakemake.output[0],
        parameters=ExperimentParameters.from_mapping(snakemake.params.parameters),
    )
