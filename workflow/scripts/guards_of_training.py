"""Try the guards of training and of random places on a run."""

from visuohaptic.geometry.surface import meshes_in
from visuohaptic.guards.training import make_training_guards
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_training_guards(
        features=snakemake.input.features,
        fixations=snakemake.input.fixations,
        meshes=meshes_in(snakemake.input.meshes),
        output=snakemake.output[0],
        pipelines=snakemake.params.pipelines,
        recognition=RecognitionParameters(**snakemake.params.recognition),
        seed=snakemake.params.seed,
    )
