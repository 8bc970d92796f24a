"""Bring the models that the chosen set needs and the repository does not hold."""

from visuohaptic.downloads import fetch_models
from visuohaptic.jobs import logged_job

with logged_job(snakemake.log[0]):
    fetch_models(
        models=snakemake.params.models,
        folder="meshes/downloaded",
        cache=snakemake.params.cache,
        jobs=snakemake.threads,
    )
