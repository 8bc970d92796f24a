"""Try the guards on a run."""

from visuohaptic_workflow.object_blocks import files_of

from visuohaptic.guards.files import make_guards
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_guards(
        features=files_of(snakemake.input.features),
        fixations=files_of(snakemake.input.fixations),
        meshes=files_of(snakemake.input.meshes),
        predictions=snakemake.input.predictions,
        metrics=snakemake.input.metrics,
        output=snakemake.output[0],
        pipelines=snakemake.params.pipelines,
        recognition=RecognitionParameters(**snakemake.params.recognition),
        seed=snakemake.params.seed,
    )
