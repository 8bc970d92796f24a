"""Shared by all rules: parameters, objects, blocks of viewpoints, and what each job takes."""

import atexit
import json
import os
import platform
import sys
from functools import cache, partial
from pathlib import Path

# This file's own place: the folder of the Snakefile that was called may be another workflow's.
ROOT = Path(os.path.abspath(sys._getframe().f_code.co_filename)).parents[2]
SOURCES = [ROOT / "src", ROOT / "packages/contourlets/src", ROOT / "workflow/lib"]
# Where the user's studies lie: in the working folder, and in the clone.
STUDY_FOLDERS = [Path("studies").absolute(), ROOT / "studies"]
sys.path[:0] = map(str, SOURCES)

from visuohaptic.base.errors import VisuohapticError
from visuohaptic.meshes.catalogue import (
    check_classes,
    companions,
    find_own_models,
    models_of_set,
)
from visuohaptic.parameters import (
    ExperimentParameters,
    check_run,
    read_parameters,
)
from visuohaptic.phases import OF_OBJECT, inputs_needed_from, phase as phase_of
from visuohaptic.io.plugins import (
    load_files,
    load_in_child_processes,
    load_installed,
    loaded,
)
from visuohaptic.io.yaml_files import check_config, check_spelling
from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic_workflow.blocks import divide
from visuohaptic_workflow.code_of_jobs import CODE, STEP, Runs, code_of, imports_of
from visuohaptic_workflow.digests import Digests
from visuohaptic_workflow.dvc_lock import (
    IN_STAGE,
    check_clone,
    is_committed,
    is_lockable,
    lock_in_new_process,
    make_empty_outputs,
    write_lock,
)
from visuohaptic_workflow.jobs import (
    set_job_environment,
    without_studies_of_clones,
)
from visuohaptic_workflow.keys import Keys, read_record
from visuohaptic_workflow.markers import mark_stale
from visuohaptic_workflow.one_run import (
    check_folder,
    check_writable,
    claim_folder,
    claim_results,
    is_claimed_by_another,
)
from visuohaptic_workflow.planning import (
    Declared,
    fill,
    plan_jobs,
    values_of_option,
)
from visuohaptic_workflow.records import PREFIX
from visuohaptic_workflow.termination import (
    end_at_once,
    is_termination_asked,
    pass_termination_on,
)
from visuohaptic_workflow.why import ASKED, verify, why

# The environment in which the run was called, for the process that writes DVC's lock.
ENVIRONMENT = {
    name: value
    for name, value in os.environ.items()
    if not name.startswith("VISUOHAPTIC_")
}
set_job_environment(*SOURCES)
sys.path[:] = [*without_studies_of_clones(sys.path), *map(str, STUDY_FOLDERS)]
# Another workflow that uses this one as a module decides by its own means.
IS_MAIN = Path(workflow.main_snakefile).parent in (ROOT, ROOT / "workflow")
# A job on another machine parses this file, too, and takes over what the run was planned with.
HERE = f"{platform.node()}:{os.getpid()}"
IS_PLANNER = os.environ.setdefault("VISUOHAPTIC_RUN", HERE) == HERE
# In a storage, where records can't be read at the start, and in another workflow, Snakemake's own memory decides.
IS_KEYED = IS_MAIN and workflow.storage_settings.default_storage_provider is None
# Whether this process decides by keys what runs.
DECIDES = IS_KEYED and IS_PLANNER
DIGESTS = Digests(".cache/digests.json")
READ_IMPORTS = partial(DIGESTS.remembered, imports_of)


def stop(sentence):
    """End with a sentence; as a module of another workflow, leave the end to that."""
    if not IS_MAIN:
        raise WorkflowError(sentence)
    print(f"error: {sentence}", file=sys.stderr)
    sys.exit(1)


def or_stop(function, *arguments):
    """Call a function; on an error of this package, end with its message, not a traceback."""
    try:
        return function(*arguments)
    except VisuohapticError as error:
        stop(error)


or_stop(check_folder, ROOT, Path.cwd())
if DECIDES:
    # Also where nothing runs: files of a new clone would be read again each time.
    atexit.register(DIGESTS.save)
    os.environ[PREFIX] = sys.prefix
    if set(values_of_option(sys.argv, "--rerun-triggers")) - {"mtime"}:
        stop(
            "Keys decide what runs here, and Snakemake's other reasons would run it again for ever: "
            "leave out --rerun-triggers, or say --rerun-triggers mtime."
        )
    if ASKED not in os.environ:
        or_stop(check_writable)
    if IN_STAGE in os.environ:
        or_stop(check_clone)
        make_empty_outputs()


def shipped(path):
    """Give the path of a file or folder of the repository, relative to the working folder."""
    return path if Path(path).exists() else os.path.relpath(ROOT / path)


# From another folder the workflow runs with that folder's parameters, or else with its own.
configfile: shipped("params.yaml")


# Those of a workflow that uses this one as a module are its own matter.
for file in workflow.configfiles if IS_MAIN else []:
    or_stop(check_spelling, file)
if IS_MAIN and IS_PLANNER:
    for given in values_of_option(sys.argv, "--config", "-C"):
        or_stop(check_config, given)
# Before anything is checked by the names that they register; jobs load them as the package is imported.
or_stop(load_installed)
or_stop(load_files, config.get("plugins", []))
load_in_child_processes()
PARAMETERS = or_stop(ExperimentParameters.from_mapping, config)
or_stop(check_run, PARAMETERS)
CATALOGUED = {
    model.key: model
    for model in or_stop(
        models_of_set, shipped("meshes/catalogue.csv"), PARAMETERS.meshes.set
    )
}
OWN_MODELS = find_own_models("meshes/own", CATALOGUED)
OWN = {model.key: path for model, path in OWN_MODELS.models.items()}
COMPANIONS = companions(OWN.values())
if IS_PLANNER:
    for sentence in OWN_MODELS.set_aside.values():
        print(f"warning: {sentence}", file=sys.stderr)
DOWNLOADED = {
    key: model
    for key, model in CATALOGUED.items()
    if not Path(shipped(f"meshes/paper/{key}.ply.gz")).exists()
}
OBJECTS = sorted({**CATALOGUED, **OWN})
OBJECT_BLOCKS = divide(OBJECTS, PARAMETERS.workflow.objects_per_job)
# The viewpoints of a job, by names such as 00-15.
VIEW_BLOCKS = {}
for start in range(0, PARAMETERS.viewpoints.total, PARAMETERS.workflow.views_per_job):
    end = min(start + PARAMETERS.workflow.views_per_job, PARAMETERS.viewpoints.total)
    VIEW_BLOCKS[f"{start:02d}-{end - 1:02d}"] = list(range(start, end))
# What wildcards stand for, in rules that do not list their jobs' wildcards.
VALUES = {
    "objects": OBJECT_BLOCKS,
    "views": VIEW_BLOCKS,
    "pipeline": PARAMETERS.recognition.pipelines,
    "strategy": PARAMETERS.probing.strategies,
}
VALUES_OF_RULES = {}


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
    return [
        (
            f"meshes/downloaded/{key}.ply.gz"
            if key in DOWNLOADED
            else local(str(OWN.get(key) or shipped(f"meshes/paper/{key}.ply.gz")))
        )
        for key in OBJECT_BLOCKS[wildcards.objects]
    ]


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


def blocks_with(objects):
    """Name the blocks that hold at least one of some objects."""
    return [
        name
        for name, block in OBJECT_BLOCKS.items()
        if not {*block}.isdisjoint(objects)
    ]


def meshes_of(objects=OBJECTS):
    """List the folders that hold the meshes of some objects, and may hold others."""
    return expand("results/meshes/{objects}", objects=blocks_with(objects))


def files_of(table, each="{objects}/{views}", suffix="parquet", **chosen):
    """List the files of a table, one for each value of some wildcards, or for those that are chosen."""
    return expand(f"results/{table}/{each}.{suffix}", **{**VALUES, **chosen})


def views_of(table):
    """List the files of a table that belong to one block of objects, which a job names."""
    return [f"results/{table}/{{objects}}/{views}.parquet" for views in VIEW_BLOCKS]


def places_of(files, **chosen):
    """List the files of all places, chosen before the first touch or by policies; `files` is `files_of` or `views_of`."""
    return [*files("fixations", **chosen), *files("policy_fixations", **chosen)]


# What each rule runs and takes.
DECLARED = {}
# What the jobs of this run are given: in the process that plans it, and in those of other machines, which read it.
GIVEN_FILE = Path("logs/given.json")
GIVEN = {}


def takes(name, script=None, own=(), **inputs):
    """Declare what a rule runs and takes; give its input, files whose times count for nothing where its record fits.

    The script has the rule's name, unless another one is given; it also runs `own` files, which lie outside of the library.
    """
    path = ROOT / "workflow/scripts" / (script or f"{name}.py")
    runs = Runs(path, CODE.get(name, STEP), tuple(own))
    DECLARED[name] = Declared(runs, inputs)

    def found(wildcards):
        files = DECLARED[name].files(wildcards)
        if not IS_KEYED:
            code = in_clone(map(os.path.relpath, find_code(runs).files))
            return {**files, "code": code}
        if not IS_PLANNER:
            return files
        record = fill(str(getattr(rules, name).output.record), wildcards)
        reason = keys().why(record)
        if reason is None:
            return {
                part: ancient(item) if isinstance(item, str) else [*map(ancient, item)]
                for part, item in files.items()
            }
        GIVEN[record] = keys().given(record)
        if is_claimed_by_another():  # which makes it, or will be waited for
            return files
        marker = or_stop(mark_stale, record, reason, keys().jobs[record].tables)
        return {**files, "why": [*marker, *sorted(keys().stale_behind(record))]}

    return unpack(found)


def key_of_job(wildcards, output):
    """Give what tells a job its key, and what it was planned with."""
    if not IS_KEYED:
        return None
    if not IS_PLANNER:
        return json.loads(GIVEN_FILE.read_text(encoding="utf-8")).get(output.record)
    if output.record not in GIVEN:
        GIVEN[output.record] = keys().given(output.record)
    return GIVEN[output.record]


@cache
def keys():
    """Give the keys of all jobs that today's parameters and objects ask for."""
    jobs = [
        job
        for name, declared in DECLARED.items()
        for job in plan_jobs(
            name, declared, getattr(rules, name), VALUES_OF_RULES.get(name, VALUES)
        )
    ]
    kept = {
        job.record
        for job in jobs
        if any(study.owns(job.outputs[0]) for study in KEPT_STUDIES)
    }
    return Keys(jobs, find_code, DIGESTS, ROOT, kept)


@cache
def find_code(runs):
    """Find the code of a job, plug-ins among it."""
    return code_of(runs, SOURCES, STUDY_FOLDERS, loaded(), READ_IMPORTS)


def all_cores(wildcards):
    """Give the number of cores for a job that must run alone; profiles of clusters set it to one."""
    return workflow.cores or 1


def answer():
    """Answer `make why` or `make verify`, or let DVC write its lock, if this process is asked to, and end."""
    if not DECIDES or ASKED not in os.environ:
        return
    targets, is_fine = [*map(str, rules.all.input)], True
    if os.environ[ASKED] == "lock":
        or_stop(claim_results)
        or_stop(write_lock, keys(), targets, are_parameters_current)
        sys.exit()
    lines = why(keys(), targets)
    if os.environ[ASKED] == "verify":
        lines, is_fine = verify(keys())
    print(*lines, sep="\n")
    sys.exit(not is_fine)


def claim():
    """Allow one run at a time in this folder, and say what its jobs were planned with."""
    if DECIDES:
        or_stop(claim_folder)
        pass_termination_on()
        atomic_write_text(GIVEN_FILE, json.dumps(GIVEN))


def close_run():
    """Put aside what is no longer named, and say what was left out, what is of an earlier state, and what the report holds, once it is today's."""
    if not DECIDES:
        return
    # With Arrow, which a run that has nothing to do never needs.
    from visuohaptic_workflow.closing import lines_at_end, put_aside

    end_at_once()
    found = {record: read_record(record).get("key") for record in keys().jobs}
    stale = {record: key for record, key in found.items() if key != keys().key(record)}
    report_is_current = "results/records/report.json" not in stale
    lines = []
    if report_is_current:
        named = {file for job in keys().jobs.values() for file in job.outputs}
        lines += put_aside(named)
    if any(stale.values()):
        count = sum(key is not None for key in stale.values())
        lines.append(
            f"{count} records are of an earlier state: `make verify` lists them."
        )
    lines += lines_at_end(report_is_current=report_is_current)
    for line in lines:
        print(line, file=sys.stderr)
    make_empty_outputs()
    if is_lockable() and not is_termination_asked():
        lock({*stale})


def are_parameters_current():
    """Return whether params.yaml, read again, has the parameters of this process."""
    return read_parameters("params.yaml") == PARAMETERS


def lock(stale):
    """Let DVC lock a whole run by the parameters of params.yaml; some records are stale."""
    if not or_stop(are_parameters_current):
        print(
            "dvc.lock stays as it was: this run's parameters are not those of params.yaml.",
            file=sys.stderr,
        )
        return
    needed = {*keys().needed_for(map(str, rules.all.input))}
    if needed & stale - {*keys().kept}:
        return
    print("DVC reads the results and writes dvc.lock.", file=sys.stderr)
    lock_in_new_process({**ENVIRONMENT, ASKED: "lock"})
    if Path("dvc.lock").exists() and not is_committed():
        print(
            "`git add dvc.lock && git commit -m Results` lets queued experiments start with these results.",
            file=sys.stderr,
        )
