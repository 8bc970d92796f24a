"""Recognise objects by eye, by touch and by both, in good sight and in poor."""

from visuohaptic.geometry.surface import meshes_in
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.looking.files import make_looking
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_looking(
        meshes=list(meshes_in(snakemake.input.meshes).values()),
        candidates=snakemake.input.candidates,
        table=snakemake.output.table,
        metrics=snakemake.output.metrics,
        run=ExperimentParameters.from_mapping(snakemake.params.parameters),
        processes=snakemake.threads,
    )
