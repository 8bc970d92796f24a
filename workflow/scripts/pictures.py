"""Make the report's pictures of a block of objects."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from visuohaptic.geometry.surface import meshes_in
from visuohaptic.pictures.object_pictures import make_pictures
from visuohaptic_workflow.jobs import job

with job(snakemake):
    make_pictures(
        meshes=meshes_in([snakemake.input.meshes]),
        views=snakemake.input.views,
        touches=snakemake.input.touches,
        stability=snakemake.input.stability,
        output=snakemake.output[0],
        shown=snakemake.params.shown,
        faces=snakemake.params.faces,
        layout=snakemake.params.layout,
    )
