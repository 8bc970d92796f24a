"""Prepare the meshes of a block of objects."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.files import make_meshes
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_meshes(
        models={
            key: Model(*key.split("/"), **model) if model else None
            for key, model in snakemake.params.models.items()
        },
        sources=dict(zip(snakemake.params.models, snakemake.input.sources, strict=True)),
        folder=snakemake.output[0],
        parameters=MeshParameters(**snakemake.params.meshes),
        seed=snakemake.params.seed,
    )
