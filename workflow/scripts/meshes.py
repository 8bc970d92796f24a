"""Prepare one object's mesh."""

from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.files import make_mesh
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_mesh(
        key=snakemake.wildcards.object,
        model=Model(*snakemake.wildcards.object.split("/"), **snakemake.params.model)
        if snakemake.params.model
        else None,
        source=snakemake.input.source[0],
        output=snakemake.output[0],
        parameters=MeshParameters(**snakemake.params.meshes),
    )
