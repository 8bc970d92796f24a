"""Do a step of a study: what its conditions' blocks do not do."""

from pathlib import Path

import pyarrow as pa  # noqa: F401 - `job` keeps it from importing pandas, once it is there

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.study import StepInputs, do_step
from visuohaptic_workflow import jobs
from visuohaptic_workflow.jobs import job

CLONE = Path(jobs.__file__).parents[3]

with job(snakemake):
    asked = snakemake.params
    inputs = {name: list(snakemake.input[name]) for name in asked.inputs}
    if "meshes" in inputs:
        from visuohaptic.geometry.surface import meshes_in

        inputs["meshes"] = list(meshes_in(inputs["meshes"], asked.measured).values())
    do_step(
        asked.work,
        [Path("studies").absolute(), CLONE / "studies"],
        StepInputs(
            study=asked.study,
            inputs=inputs,
            outputs=list(snakemake.output[: asked.files]),
            run=ExperimentParameters.from_mapping(asked.parameters),
            wildcards=dict(snakemake.wildcards.items()),
            made=dict(zip(asked.recomputed, inputs.get("made", ()), strict=True)),
            objects=asked.sample,
            condition=asked.condition,
            processes=snakemake.threads,
        ),
    )
