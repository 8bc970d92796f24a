"""Recompute features that conditions of a study share."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from visuohaptic.geometry.surface import meshes_in
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.phases import inputs_needed_from
from visuohaptic.studies.conditions import Recomputation
from visuohaptic.studies.recomputing import Sources, make_study_features
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_study_features(
        recomputation=Recomputation(
            snakemake.params.phase,
            ExperimentParameters.from_mapping(snakemake.params.parameters),
        ),
        sources=Sources(
            meshes=list(meshes_in(snakemake.input.meshes, snakemake.params.sample).values()),
            tables={
                name: snakemake.input.get(name)
                for name in inputs_needed_from(snakemake.params.phase)
                if name != "meshes"
            },
            objects=snakemake.params.sample,
        ),
        output=snakemake.output[0],
    )
