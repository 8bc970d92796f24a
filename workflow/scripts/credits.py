"""Write the authors and licences of the downloaded models."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from visuohaptic.meshes.catalogue import Credit, Model, write_credits
from visuohaptic_workflow.jobs import job

with job(snakemake):
    write_credits(
        models=[
            Model(**{**model, "credit": Credit(**model["credit"])})
            for model in snakemake.params.models
        ],
        path=snakemake.output.credits,
    )
