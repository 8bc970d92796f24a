"""Make features again that conditions of a study share."""

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import Remake
from visuohaptic.studies.files import make_study_features
from visuohaptic.studies.measuring import Sources
from visuohaptic_workflow.jobs import job
from visuohaptic_workflow.object_blocks import files_of

with job(snakemake):
    make_study_features(
        remake=Remake(
            snakemake.params.phase,
            ExperimentParameters.from_mapping(snakemake.params.parameters),
        ),
        sources=Sources(
            meshes=files_of(snakemake.input.meshes, snakemake.params.sample),
            fixations=files_of(snakemake.input.fixations, snakemake.params.sample),
            touches=files_of(snakemake.input.touches, snakemake.params.sample),
        ),
        output=snakemake.output[0],
    )
