"""Take a block of objects and of viewpoints through one phase."""

from visuohaptic.functions import Function
from visuohaptic.geometry.surface import meshes_in
from visuohaptic.one_phase import run_files
from visuohaptic_workflow.jobs import job

with job(snakemake):
    params, inputs, outputs = (
        dict(part.items()) for part in (snakemake.params, snakemake.input, snakemake.output)
    )
    del params["key"], outputs["record"]
    run_files(
        work=Function(params.pop("work")),
        viewpoints=params.pop("viewpoints_of_block"),
        arguments=params,
        meshes=meshes_in(filter(None, [inputs.pop("meshes", None)])),
        inputs={name: file for name, file in inputs.items() if name not in {"why", "code"}},
        outputs=outputs,
    )
