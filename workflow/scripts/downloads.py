"""Bring the models that the chosen set needs and the repository does not hold."""

from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.downloads import fetch_models
from visuohaptic_workflow.jobs import job

with job(snakemake):
    fetch_models(
        models=[Model(**model) for model in snakemake.params.models],
        folder="meshes/downloaded",
        cache=snakemake.params.cache,
        jobs=snakemake.threads,
    )
