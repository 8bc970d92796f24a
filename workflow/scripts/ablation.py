"""Measure one ablation."""

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.ablations.measuring import Sources, make_ablation
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_ablation(
        name=snakemake.wildcards.ablation,
        sources=Sources(
            meshes=snakemake.input.meshes,
            fixations=snakemake.input.fixations,
            touches=snakemake.input.touches,
            features=snakemake.input.features,
        ),
        output=snakemake.output[0],
        parameters=ExperimentParameters.from_mapping(snakemake.params.parameters),
    )
