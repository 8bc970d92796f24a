"""What all rule files share: parameters, objects, blocks of viewpoints, and code as input."""

import os
import sys
from pathlib import Path

SOURCE = Path(workflow.basedir, "src")
# Jobs import the package of this checkout, whatever else is installed.
sys.path.insert(0, str(SOURCE))
os.environ["PYTHONPATH"] = str(SOURCE)
# Parallelism is jobs; threads inside each would only compete.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

from visuohaptic.catalogue import companions, find_own_models, models_of_set
from visuohaptic.code_inputs import code_inputs
from visuohaptic.errors import VisuohapticError
from visuohaptic.parameters import Parameters
from visuohaptic.tables import prune_parts


def or_stop(function, *arguments):
    """Call a function; where it refuses, end with its sentence instead of a traceback."""
    try:
        return function(*arguments)
    except VisuohapticError as error:
        raise WorkflowError(str(error)) from None


PARAMETERS = or_stop(Parameters.from_mapping, config)
CATALOGUED = {
    model.key: model
    for model in or_stop(models_of_set, "meshes/catalogue.csv", PARAMETERS.meshes.set)
}
OWN = {
    model.key: path
    for model, path in or_stop(find_own_models, "meshes/own", CATALOGUED).items()
}
OBJECTS = sorted({**CATALOGUED, **OWN})


wildcard_constraints:
    object="[^/]+/[^/]+",
    views=r"\d+-\d+",
    pipeline="[a-z_]+",
    strategy="[a-z_]+",


def view_blocks():
    """Name the blocks of viewpoints that a job each covers, such as 00-15."""
    count, step = PARAMETERS.viewpoints.count, PARAMETERS.workflow.views_per_job
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


def code_of(script):
    """List the modules that a script runs: an edit in one of them reruns the script's jobs."""
    files = code_inputs(Path(workflow.basedir, "workflow/scripts", script), SOURCE)
    return [os.path.relpath(file, workflow.basedir) for file in files]


def prune_tables():
    """Delete parts of tables that the parameters and objects of today no longer name."""
    for table in ("views", "fixations", "touches", "features"):
        prune_parts(f"results/{table}", parts_of(table))
    for table in ("scores", "predictions"):
        prune_parts(f"results/{table}", scores_of(table))
