"""Measure one ablation."""

from visuohaptic.ablation import Sources, make_ablation
from visuohaptic.jobs import logged_job
from visuohaptic.parameters import ExperimentParameters

with logged_job(snakemake.log[0]):
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
