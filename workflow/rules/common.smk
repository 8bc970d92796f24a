"""Shared by all rules: parameters, objects, blocks of viewpoints, and code as input."""

import os
import sys
from functools import cache
from pathlib import Path

# This file's own place: the folder of the Snakefile that was called may be another workflow's.
ROOT = Path(os.path.abspath(sys._getframe().f_code.co_filename)).parents[2]
SOURCES = [ROOT / "src", ROOT / "packages/contourlets/src", ROOT / "workflow/lib"]
sys.path[:0] = map(str, SOURCES)

from visuohaptic_workflow.stopping import (
    end_at_ctrl_c,
    end_at_sigterm,
    end_if_stopped,
    let_snakemake_cancel_jobs,
)

# What a workflow that uses this one as a module does at Ctrl-C is its own choice.
IS_MAIN = Path(workflow.main_snakefile).parent in (ROOT, ROOT / "workflow")
if IS_MAIN and workflow.is_main_process:
    end_at_ctrl_c()

from visuohaptic.errors import VisuohapticError
from visuohaptic.meshes.catalogue import (
    check_classes,
    companions,
    find_own_models,
    models_of_set,
)
from visuohaptic.parameters import (
    ExperimentParameters,
    check_run,
    refuse_repeated_names,
)
from visuohaptic.scene.parameters import VISUAL_EFFECTS
from visuohaptic_workflow.blocks import divide
from visuohaptic_workflow.brought_files import judge_brought_files
from visuohaptic_workflow.closing import lines_at_end
from visuohaptic_workflow.code_inputs import code_inputs, load_memory, save_memory
from visuohaptic_workflow.jobs import set_job_environment
from visuohaptic_workflow.one_run import (
    check_writable,
    claim_folder,
    is_claimed_by_another,
)
from visuohaptic_workflow.plan import plan_jobs, prune_files, runs_jobs

set_job_environment(*SOURCES)
IMPORTS = ".snakemake/imports.json"
load_memory(IMPORTS)

# Snakemake imports pandas, for half a second, to look for data frames among parameters; here are
# none. A workflow that uses this one as a module may have some.
if IS_MAIN:
    sys.modules.setdefault("pandas", None)


def or_stop(function, *arguments):
    """Call a function; on an error of this package, end with its message, not a traceback."""
    try:
        return function(*arguments)
    except VisuohapticError as error:
        raise WorkflowError(str(error)) from None


def shipped(path):
    """Give the path of a file or folder of the repository, relative to the working folder."""
    if Path(path).exists():
        return path
    return os.path.relpath(ROOT / path)


# From another folder the workflow runs with that folder's parameters, or else with its own.
configfile: shipped("params.yaml")


# Those of a workflow that uses this one as a module are its own matter.
for file in workflow.configfiles if IS_MAIN else []:
    or_stop(refuse_repeated_names, file)
PARAMETERS = or_stop(ExperimentParameters.from_mapping, config)
or_stop(check_run, PARAMETERS)
# Of each sequence of touches.
WANTED = {
    "touches": PARAMETERS.attention.fixations,
    "unreachable": PARAMETERS.probing.unreachable,
    "when_exhausted": PARAMETERS.probing.when_exhausted,
}
CATALOGUED = {
    model.key: model
    for model in or_stop(
        models_of_set, shipped("meshes/catalogue.csv"), PARAMETERS.meshes.set
    )
}
OWN_MODELS = find_own_models("meshes/own", CATALOGUED)
OWN = {model.key: path for model, path in OWN_MODELS.models.items()}
COMPANIONS = companions(OWN.values())
if workflow.is_main_process:
    for sentence in OWN_MODELS.set_aside.values():
        print(f"warning: {sentence}", file=sys.stderr)
DOWNLOADED = {
    key: model
    for key, model in CATALOGUED.items()
    if not Path(shipped(f"meshes/paper/{key}.ply.gz")).exists()
}
OBJECTS = sorted({**CATALOGUED, **OWN})
OBJECT_BLOCKS = divide(OBJECTS, PARAMETERS.workflow.objects_per_job)


wildcard_constraints:
    objects="[^/]+/[^/]+",
    views=r"\d+-\d+",
    pipeline="[a-z_]+",
    strategy="[a-z_]+",


def in_clone(files):
    """Mark files that no job makes: they are where the workflow is, also where results are kept in a storage."""
    return [local(str(file)) for file in files]


def sources_of(wildcards):
    """List the model file of each object of a block."""
    return [source_of(key) for key in OBJECT_BLOCKS[wildcards.objects]]


def source_of(key):
    """Give an object's model file."""
    if key in OWN:
        return in_clone([OWN[key]])[0]
    if key in DOWNLOADED:
        return f"meshes/downloaded/{key}.ply.gz"
    return in_clone([shipped(f"meshes/paper/{key}.ply.gz")])[0]


def companions_of(wildcards):
    """List the files that the model files of a block refer to."""
    models = [OWN[key] for key in OBJECT_BLOCKS[wildcards.objects] if key in OWN]
    return in_clone(file for model in models for file in COMPANIONS[model])


def models_of(wildcards):
    """Give the size in cm and the rotation to upright of each object of a block, from the catalogue."""
    found = {key: CATALOGUED.get(key) for key in OBJECT_BLOCKS[wildcards.objects]}
    return {
        key: model and {"dimensions": model.dimensions, "rotation": model.rotation}
        for key, model in found.items()
    }


def view_blocks():
    """Name the blocks of viewpoints, one a job, such as 00-15."""
    count, step = PARAMETERS.viewpoints.total, PARAMETERS.workflow.views_per_job
    starts = range(0, count, step)
    return [f"{start:02d}-{min(start + step, count) - 1:02d}" for start in starts]


def viewpoints_of(wildcards):
    """List the viewpoints of a block."""
    first, last = wildcards.views.split("-")
    return list(range(int(first), int(last) + 1))


def blocks_with(objects):
    """Name the blocks that hold at least one of some objects."""
    wanted = set(objects)
    return [
        name for name, block in OBJECT_BLOCKS.items() if not wanted.isdisjoint(block)
    ]


def meshes_of(objects=OBJECTS):
    """List the folders that hold the meshes of some objects, and may hold others."""
    return expand("results/meshes/{objects}", objects=blocks_with(objects))


def files_by_block(table, suffix="parquet"):
    """List the files of a table with one file a block of objects."""
    return expand(f"results/{table}/{{objects}}.{suffix}", objects=OBJECT_BLOCKS)


def parts_of(table, suffix="parquet", objects=OBJECTS, views=None):
    """List the files of a table, one a block of objects and of viewpoints, that hold some objects and may hold others."""
    return expand(
        "results/{table}/{objects}/{views}.{suffix}",
        table=table,
        suffix=suffix,
        objects=blocks_with(objects),
        views=views or view_blocks(),
    )


def views_of(table):
    """List the files of a table that belong to one block of objects, which a job names."""
    return [f"results/{table}/{{objects}}/{views}.parquet" for views in view_blocks()]


def scores_of(table, suffix="parquet"):
    """List the files of a table of the recognition phase."""
    return expand(
        "results/{table}/{pipeline}/{strategy}.{suffix}",
        table=table,
        suffix=suffix,
        pipeline=PARAMETERS.recognition.pipelines,
        strategy=PARAMETERS.probing.strategies,
    )


def code_of(script):
    """List a script and the modules that it runs: an edit in one of them reruns its jobs."""
    file = ROOT / "workflow/scripts" / script
    return in_clone(map(os.path.relpath, [file, *code_inputs(file, SOURCES)]))


def packed_code(wildcards):
    """List the files of the workflow that are packed, beside its results."""
    from visuohaptic_workflow.crate import list_code

    files = ["workflow/Snakefile", *list_code(ROOT)]
    return in_clone(os.path.relpath(ROOT / file) for file in files)


def packed_commit(wildcards):
    """Name the commit of the workflow."""
    from visuohaptic.report.provenance import find_commit

    return find_commit()


def all_cores(wildcards):
    """Give the number of cores for a job that must run alone; on a cluster it is one."""
    return workflow.cores if workflow.local_exec else 1


# Rules whose wildcards stand for other values than in the rest, or that list their jobs' wildcards.
VALUES_OF_RULES = {}


@cache
def planned_jobs():
    """List the jobs of all rules that today's parameters and objects ask for."""
    values = {
        "objects": OBJECT_BLOCKS,
        "views": view_blocks(),
        "pipeline": PARAMETERS.recognition.pipelines,
        "strategy": PARAMETERS.probing.strategies,
    }
    # In a workflow that uses this one as a module, workflow.rules has other rules and other names.
    by_name = dict(rules._rules)
    return plan_jobs(by_name, values, VALUES_OF_RULES)


def check_folder():
    """Allow one run at a time in this folder, and check files that were not made here."""
    if not (IS_MAIN and workflow.is_main_process):
        return
    or_stop(check_writable)
    if runs_jobs(sys.argv):
        or_stop(claim_folder, ["results", "reports", "meshes/downloaded"])
    elif is_claimed_by_another():
        return
    save_memory(IMPORTS)
    outdated = judge_brought_files(
        [
            job
            for job in planned_jobs()
            if not any(belongs_to(job, study) for study in KEPT_STUDIES)
        ]
    )
    if outdated:
        print(
            f"{len(outdated)} jobs have files that were brought here and made with other "
            "parameters, code or inputs than today's; they run again.",
            file=sys.stderr,
        )


def check_recognition():
    """Stop before the first job where recognition is asked for and has no classes to tell apart."""
    planned = getattr(getattr(workflow, "dag", None), "needrun_jobs", list)
    if any(job.rule.name == "recognition" for job in planned()):
        or_stop(check_classes, OBJECTS)


def prune():
    """Delete results and logs that today's parameters and objects no longer name, where the report is asked for.

    The report takes all tables; a run with another target may be about another set of objects.
    """
    asked = getattr(getattr(workflow, "dag", None), "jobs", ())
    if any(job.rule.name == "report" for job in asked):
        prune_files(planned_jobs(), ["results", "logs"])


def say_results():
    """Say at the end of a run what was left out, and what the report holds if it was written."""
    if "--logger" in sys.argv:  # it says so itself
        return
    finished = workflow.dag.finished_jobs
    is_written = any(job.rule.name == "report" for job in finished)
    for line in lines_at_end(report_is_current=is_written):
        print(line, file=sys.stderr)


def start_local_jobs_at_once():
    """Remove the limit of job starts per second if jobs run on this machine.

    For that limit Snakemake checks all ready jobs once a second, and again
    after each job: with 600 jobs it would keep one core busy.
    """
    scheduler = getattr(workflow, "scheduler", None)
    if workflow.local_exec and hasattr(scheduler, "job_rate_limiter"):
        scheduler.job_rate_limiter = None


def stop_at_sigterm():
    """End at SIGTERM at any moment."""
    scheduler = getattr(workflow, "scheduler", None)
    if IS_MAIN and hasattr(scheduler, "exit_gracefully"):
        end_at_sigterm(scheduler)


def stop_remote_jobs_at_ctrl_c():
    """Leave it to Snakemake at Ctrl-C to cancel jobs that run on other machines."""
    if not workflow.local_exec:
        let_snakemake_cancel_jobs()
