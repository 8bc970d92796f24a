"""Measure a block of a study's conditions."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from visuohaptic.studies.measuring import make_study_block
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_study_block(
        study=snakemake.wildcards.study,
        conditions=snakemake.params.conditions,
        features=snakemake.input.features,
        recomputed_features=dict(
            zip(snakemake.params.recomputed, snakemake.input.recomputed_features, strict=True)
        ),
        output=snakemake.output[0],
        seed=snakemake.params.seed,
        objects=snakemake.params.sample,
    )
