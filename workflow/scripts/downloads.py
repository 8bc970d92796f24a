"""Download the models of the chosen set that are not in the repository."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from pathlib import Path

from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.downloads import fetch_models
from visuohaptic_workflow.jobs import job

with job(snakemake):
    fetch_models(
        models=[Model(**model) for model in snakemake.params.models],
        # With results in a storage, the folder of the outputs is not the working folder.
        folder=Path(snakemake.output.record).parents[2] / "meshes/downloaded",
        cache=snakemake.params.cache,
        jobs=snakemake.threads,
    )
