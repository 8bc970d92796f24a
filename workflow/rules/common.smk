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
from visuohaptic_workflow.brought_files import judge_blocks, judge_brought_files
from visuohaptic_workflow.closing import lines_at_end
from visuohaptic_workflow.code_inputs import code_inputs, load_memory, save_memory
from visuohaptic_workflow.jobs import set_job_environment
from visuohaptic_workflow.object_blocks import LISTS, divide
from visuohaptic_workflow.one_run import (
    check_writable,
    claim_folder,
    is_claimed_by_another,
)
from visuohaptic_workflow.plan import plan_jobs, prune_files, runs_jobs
from visuohaptic_workflow.warm_start import offer_warm_starts

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
# DVC's stages are phases, and a block runs through all of them.
OBJECT_BLOCKS = divide(
    OBJECTS,
    None if "DVC_STAGE" in os.environ else PARAMETERS.workflow.objects_per_job,
)
if OBJECT_BLOCKS and workflow.storage_settings.default_storage_provider is not None:
    raise WorkflowError(
        "workflow.objects_per_job needs a file system that all jobs share, and results are kept in "
        "a storage; leave it null, or leave out --default-storage-provider."
    )


wildcard_constraints:
    object="[^/]+/[^/]+",
    objects=r"\d+-\d+",
    views=r"\d+-\d+",
    pipeline="[a-z_]+",
    strategy="[a-z_]+",


def in_clone(files):
    """Mark files that no job makes: they are where the workflow is, also where results are kept in a storage."""
    return [local(str(file)) for file in files]


def source_of(wildcards):
    """Give an object's model file, and the files that it refers to."""
    if wildcards.object in OWN:
        model = OWN[wildcards.object]
        return in_clone([model, *COMPANIONS[model]])
    if wildcards.object in DOWNLOADED:
        return [f"meshes/downloaded/{wildcards.object}.ply.gz"]
    return in_clone([shipped(f"meshes/paper/{wildcards.object}.ply.gz")])


def model_of(wildcards):
    """Give an object's size in cm and its rotation to upright, from the catalogue."""
    model = CATALOGUED.get(wildcards.object)
    if model is None:
        return {}
    return {"dimensions": model.dimensions, "rotation": model.rotation}


def view_blocks():
    """Name the blocks of viewpoints, one a job, such as 00-15."""
    count, step = PARAMETERS.viewpoints.total, PARAMETERS.workflow.views_per_job
    starts = range(0, count, step)
    return [f"{start:02d}-{min(start + step, count) - 1:02d}" for start in starts]


def viewpoints_of(wildcards):
    """List the viewpoints of a block."""
    first, last = wildcards.views.split("-")
    return list(range(int(first), int(last) + 1))


def lists_of(table):
    """List the lists that name the files of a table, one a block of objects."""
    return [f"{LISTS}/{block}/{table}.json" for block in OBJECT_BLOCKS]


def files_by_object(table, suffix="parquet", objects=OBJECTS):
    """List the files of a table with one file an object, or the lists that name them and others."""
    if OBJECT_BLOCKS:
        return lists_of(table.removeprefix("records/"))
    return expand(f"results/{table}/{{object}}.{suffix}", object=objects)


def parts_of(table, suffix="parquet", objects=OBJECTS):
    """List the files of a table with one file an object and block of viewpoints, or the lists that name them and others."""
    if OBJECT_BLOCKS:
        return lists_of(table.removeprefix("records/"))
    return part_files(table, suffix, objects)


def part_files(table, suffix="parquet", objects=OBJECTS):
    """List the files of a table with one file an object and block of viewpoints."""
    return expand(
        "results/{table}/{object}/{views}.{suffix}",
        table=table,
        suffix=suffix,
        object=objects,
        views=view_blocks(),
    )


def blocks_of(table):
    """List the files of a table that belong to one object, which a job names."""
    return [f"results/{table}/{{object}}/{views}.parquet" for views in view_blocks()]


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
        "object": OBJECTS,
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
    changed_blocks = judge_blocks(
        (job, jobs_of_blocks()[job.wildcards["objects"]])
        for job in planned_jobs()
        if job.name == "objects"
    )
    outdated = judge_brought_files(
        [
            job
            for job in planned_jobs()
            if not any(belongs_to(job, study) for study in KEPT_STUDIES)
            # A block judges its objects' files itself.
            and not (OBJECT_BLOCKS and job.name in RULES_OF_OBJECT)
            and job.record not in changed_blocks
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


def start_local_jobs_warm():
    """Start jobs on this machine as forks of a process that has done their imports."""
    if workflow.local_exec and PARAMETERS.workflow.warm_starts:
        offer_warm_starts()
        set_job_environment(ROOT / "workflow/warm_start", *SOURCES)
