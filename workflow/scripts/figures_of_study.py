"""Summarise a study: each condition's accuracy, and its difference to another condition."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.studies.figures import make_study_figures
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_study_figures(
        study=snakemake.params.study,
        parts=snakemake.input.parts,
        output=snakemake.output.figures,
        metrics=snakemake.output.metrics,
        intervals=IntervalParameters(**snakemake.params.intervals),
    )
