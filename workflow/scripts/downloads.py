"""Bring the models that the chosen set needs and the repository does not hold."""

from pathlib import Path

from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.downloads import fetch_models
from visuohaptic_workflow.jobs import job

with job(snakemake):
    fetch_models(
        models=[Model(**model) for model in snakemake.params.models],
        # Where results are kept in a storage, the outputs' folder is not the working folder.
        folder=Path(snakemake.output.record).parents[2] / "meshes/downloaded",
        cache=snakemake.params.cache,
        jobs=snakemake.threads,
    )
