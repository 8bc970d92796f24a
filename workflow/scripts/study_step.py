"""Run a step of a study."""

import visuohaptic_workflow.start_of_job  # noqa: F401 - before all imports that take time

# isort: split
from pathlib import Path

import pyarrow as pa  # noqa: F401 - imported first, so that `job` can keep it from importing pandas

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.study import StepInputs, do_step
from visuohaptic_workflow import jobs
from visuohaptic_workflow.jobs import job

CLONE = Path(jobs.__file__).parents[3]

with job(snakemake):
    params = snakemake.params
    inputs = {name: list(snakemake.input[name]) for name in params.inputs}
    if "meshes" in inputs:
        from visuohaptic.geometry.surface import meshes_in

        inputs["meshes"] = list(meshes_in(inputs["meshes"], params.measured).values())
    do_step(
        params.work,
        [Path("studies").absolute(), CLONE / "studies"],
        StepInputs(
            study=params.study,
            inputs=inputs,
            outputs=list(snakemake.output[: params.files]),
            run=ExperimentParameters.from_mapping(params.parameters),
            wildcards=dict(snakemake.wildcards.items()),
            recomputed_features=dict(
                zip(params.recomputed, inputs.get("recomputed_features", ()), strict=True)
            ),
            objects=params.sample,
            condition=params.condition,
            processes=snakemake.threads,
        ),
    )
