"""Prepare one object's mesh."""

from visuohaptic.catalogue import Model
from visuohaptic.meshes import MeshParameters, make_mesh
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_mesh(
        key=snakemake.wildcards.object,
        model=Model(*snakemake.wildcards.object.split("/"), **snakemake.params.model),
        source=snakemake.input.source[0],
        output=snakemake.output[0],
        parameters=MeshParameters(**snakemake.params.meshes),
    )
