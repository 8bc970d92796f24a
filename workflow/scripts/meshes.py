"""Prepare one object's mesh."""

from visuohaptic.jobs import logged_job
from visuohaptic.meshes import MeshParameters, make_mesh

with logged_job(snakemake.log[0]):
    make_mesh(
        key=snakemake.wildcards.object,
        model=snakemake.params.model,
        source=snakemake.input.source[0],
        output=snakemake.output[0],
        parameters=MeshParameters(**snakemake.params.meshes),
    )
