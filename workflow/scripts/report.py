"""Write the report of everything that was run."""

from pathlib import Path

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.report.files import make_report
from visuohaptic.report.run import RunFiles
from visuohaptic.report.run_folder import find_extras
from visuohaptic_workflow.jobs import job
from visuohaptic_workflow.kept_studies import find_earlier_studies
from visuohaptic_workflow.object_blocks import files_of

with job(snakemake):
    # Where results are kept in a storage, it is not the working folder.
    folder = Path(snakemake.input.metrics).parents[1]
    make_report(
        files=RunFiles(
            metrics=snakemake.input.metrics,
            predictions=snakemake.input.predictions,
            views=files_of(snakemake.input.views),
            fixations=files_of(snakemake.input.fixations),
            touches=files_of(snakemake.input.touches),
            features=files_of(snakemake.input.features),
            effects=files_of(snakemake.input.effects),
            meshes=files_of(snakemake.input.meshes),
            credits=snakemake.input.credits,
            earlier_studies=find_earlier_studies(snakemake.params.studies),
            logs="logs",
            extras=find_extras(folder, checks="."),
            folder=folder,
        ),
        output=snakemake.output[0],
        parameters=ExperimentParameters.from_mapping(snakemake.params.parameters),
        objects=snakemake.params.objects,
        processes=snakemake.threads,
    )
