"""Run jobs of phases that process one object at a time."""

from __future__ import annotations

from typing import Any

from visuohaptic.geometry.surface import meshes_in
from visuohaptic.io.phase_files import Work, run_phase_on_files


def run_block(snakemake: Any, work: Work) -> None:
    """Run a phase on a block of objects and viewpoints."""
    params, inputs, outputs = (
        dict(part.items()) for part in (snakemake.params, snakemake.input, snakemake.output)
    )
    del params["key"], params["phase"], outputs["record"]
    run_phase_on_files(
        work=work,
        viewpoints=params.pop("viewpoints_of_block"),
        arguments=params,
        meshes=meshes_in(filter(None, [inputs.pop("meshes", None)])),
        inputs={name: file for name, file in inputs.items() if name != "code"},
        outputs=outputs,
    )
