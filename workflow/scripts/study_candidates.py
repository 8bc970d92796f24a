"""Touch objects wherever the strategy adaptive may choose to."""

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.curves.adaptive import make_candidates
from visuohaptic_workflow.jobs import job
from visuohaptic_workflow.object_blocks import files_of

with job(snakemake):
    make_candidates(
        meshes=files_of(snakemake.input.meshes),
        output=snakemake.output[0],
        parameters=ExperimentParameters.from_mapping(snakemake.params.parameters),
    )
