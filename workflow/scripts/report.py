"""Write the report of the run."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from pathlib import Path

from visuohaptic.geometry.surface import meshes_in
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.report.headline import write_headline
from visuohaptic.report.page import make_report
from visuohaptic.report.run import RunFiles, extra_paths
from visuohaptic_workflow import jobs
from visuohaptic_workflow.jobs import job
from visuohaptic_workflow.keys import key_of

STUDY_FOLDERS = [Path("studies").absolute(), Path(jobs.__file__).parents[3] / "studies"]

with job(snakemake):
    # With results in a storage, this is not the working folder.
    folder = Path(snakemake.input.metrics).parents[1]
    parameters = ExperimentParameters.from_mapping(snakemake.params.parameters)
    make_report(
        files=RunFiles(
            metrics=snakemake.input.metrics,
            predictions=snakemake.input.predictions,
            views=snakemake.input.views,
            fixations=snakemake.input.fixations,
            touches=snakemake.input.touches,
            features=snakemake.input.features,
            pictures=snakemake.input.pictures,
            effects=snakemake.input.effects,
            stability=snakemake.input.stability,
            drawn=snakemake.input.drawn,
            meshes=list(meshes_in(snakemake.input.meshes).values()),
            credits=snakemake.input.credits,
            study_folders=STUDY_FOLDERS,
            logs="logs",
            extras=extra_paths(folder, checkout="."),
            folder=folder,
            own_objects=snakemake.params.own_objects,
            key=key_of(snakemake.params.key["parts"]) if snakemake.params.key else "",
        ),
        output=snakemake.output.page,
        parameters=parameters,
        objects=snakemake.params.objects,
    )
    write_headline(
        metrics=snakemake.input.metrics,
        frontier=snakemake.input.frontier,
        cost=parameters.cost,
        output=snakemake.output.headline,
    )
