"""Shared by all rules: parameters, objects, blocks of viewpoints, and code as input."""

import os
import sys
from pathlib import Path

SOURCES = [Path(workflow.basedir, "src"), Path(workflow.basedir, "workflow/lib")]
sys.path[:0] = map(str, SOURCES)

from visuohaptic.studies.ablations.settings import ABLATIONS
from visuohaptic.meshes.catalogue import companions, find_own_models, models_of_set
from visuohaptic_workflow.code_inputs import code_inputs
from visuohaptic.studies.cost.settings import FAMILIES
from visuohaptic.errors import VisuohapticError
from visuohaptic_workflow.jobs import set_job_environment
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.scene.parameters import VISUAL_EFFECTS
from visuohaptic.tables.parts import prune_parts
from visuohaptic_workflow.warm_start import offer_warm_starts

set_job_environment(*SOURCES)


def or_stop(function, *arguments):
    """Call a function; where it refuses, end with its sentence instead of a traceback."""
    try:
        return function(*arguments)
    except VisuohapticError as error:
        raise WorkflowError(str(error)) from None


PARAMETERS = or_stop(ExperimentParameters.from_mapping, config)
CATALOGUED = {
    model.key: model
    for model in or_stop(models_of_set, "meshes/catalogue.csv", PARAMETERS.meshes.set)
}
OWN = {
    model.key: path
    for model, path in or_stop(find_own_models, "meshes/own", CATALOGUED).items()
}
DOWNLOADED = {
    key: model
    for key, model in CATALOGUED.items()
    if not Path("meshes/paper", f"{key}.ply.gz").exists()
}
OBJECTS = sorted({**CATALOGUED, **OWN})
TABLES_BY_OBJECT = (
    "views",
    "fixations",
    "touches",
    "effects/views",
    "effects/touches",
    "features",
)
TABLES_BY_STRATEGY = ("scores", "predictions")


wildcard_constraints:
    object="[^/]+/[^/]+",
    views=r"\d+-\d+",
    pipeline="[a-z_]+",
    strategy="[a-z_]+",


def source_of(wildcards):
    """Give the file that an object's model comes from, and what lies beside it."""
    if wildcards.object in OWN:
        return [OWN[wildcards.object], *companions(OWN[wildcards.object])]
    folder = "downloaded" if wildcards.object in DOWNLOADED else "paper"
    return [f"meshes/{folder}/{wildcards.object}.ply.gz"]


def view_blocks():
    """Name the blocks of viewpoints that a job each covers, such as 00-15."""
    count, step = PARAMETERS.viewpoints.total, PARAMETERS.workflow.views_per_job
    starts = range(0, count, step)
    return [f"{start:02d}-{min(start + step, count) - 1:02d}" for start in starts]


def viewpoints_of(wildcards):
    """List the viewpoints of a block."""
    first, last = wildcards.views.split("-")
    return list(range(int(first), int(last) + 1))


def parts_of(table):
    """List the files that make up a table with one file an object and block of viewpoints."""
    return expand(
        "results/{table}/{object}/{views}.parquet",
        table=table,
        object=OBJECTS,
        views=view_blocks(),
    )


def scores_of(table):
    """List the files of a table of the recognition phase."""
    return expand(
        "results/{table}/{pipeline}/{strategy}.parquet",
        table=table,
        pipeline=PARAMETERS.recognition.pipelines,
        strategy=PARAMETERS.probing.strategies,
    )


def sources_of_ablation(table):
    """Give what lists the files of a table for the ablations that start from it."""
    started_from = {
        "nothing": ("features",),
        "descriptors": ("features", "touches"),
        "touches": ("meshes", "fixations"),
        "views": ("meshes",),
    }
    files = (
        expand("results/meshes/{object}.ply", object=OBJECTS)
        if table == "meshes"
        else parts_of(table)
    )

    def sources(wildcards):
        remade = ABLATIONS[wildcards.ablation].remade
        return files if table in started_from[remade] else []

    return sources


def code_of(script):
    """List the modules that a script runs: an edit in one of them reruns the script's jobs."""
    files = code_inputs(Path(workflow.basedir, "workflow/scripts", script), SOURCES)
    return [os.path.relpath(file, workflow.basedir) for file in files]


def prune_tables():
    """Delete parts of tables that the parameters and objects of today no longer name."""
    for table in TABLES_BY_OBJECT:
        prune_parts(f"results/{table}", parts_of(table))
    for table in TABLES_BY_STRATEGY:
        prune_parts(f"results/{table}", scores_of(table))


def start_local_jobs_at_once():
    """Lift the limit of job starts a second where jobs run on this machine.

    For that limit Snakemake looks at all jobs that are ready once a second, and once
    more for each job that has ended: with 600 jobs it would keep one core busy.
    """
    if workflow.local_exec:
        workflow.scheduler.job_rate_limiter = None


def start_local_jobs_warm():
    """Let jobs on this machine take over what the first of their kind have imported."""
    if workflow.local_exec and PARAMETERS.workflow.warm_starts:
        offer_warm_starts()
        set_job_environment(Path(workflow.basedir, "workflow/warm_start"), *SOURCES)
