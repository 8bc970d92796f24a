"""Shared by all rules: parameters, objects, blocks of objects and viewpoints, and inputs of jobs."""

import atexit
import gc
import json
import os
import sys
from functools import cache, partial
from pathlib import Path

# Neither collections of garbage nor the end of the process look through Snakemake's modules again.
gc.freeze()

# Whether this process plans the run. Jobs on other machines parse this file too, but use the plan of the run.
IS_PLANNER = workflow.is_main_process
ASKED = "VISUOHAPTIC_ASKED"
if IS_PLANNER:
    # Set by another run, if this shell or notebook was started by one of its jobs.
    for inherited in [name for name in os.environ if name.startswith("VISUOHAPTIC_")]:
        if inherited != ASKED:
            del os.environ[inherited]

# By the path of this file, because the main Snakefile may be another workflow's.
ROOT = Path(os.path.abspath(sys._getframe().f_code.co_filename)).parents[2]
SOURCES = [
    ROOT / "src",
    ROOT / "packages/contourlets/src",
    ROOT / "packages/meshreaders/src",
    ROOT / "workflow/lib",
]
# Folders with studies: of the working folder, and of the clone.
STUDY_FOLDERS = [Path("studies").absolute(), ROOT / "studies"]
sys.path[:0] = map(str, SOURCES)
# Whether this is the main workflow, also if the Snakefile of another folder includes it. If it is a module, the main
# workflow decides which jobs run.
IS_MAIN = workflow.modifier.is_main_snakefile()

from visuohaptic_workflow.termination import say_stopped_at_interrupt

# Before the imports that take half of the planning.
if IS_MAIN and IS_PLANNER:
    say_stopped_at_interrupt()

from visuohaptic.base.errors import VisuohapticError
from visuohaptic.meshes.catalogue import (
    check_classes,
    check_objects,
    companions,
    find_own_models,
    models_of_set,
)
from visuohaptic.parameters import read_parameters
from visuohaptic.phases import OF_OBJECT, inputs_needed_from, phase as phase_of
from visuohaptic.io.plugins import (
    load_files,
    load_in_child_processes,
    load_installed,
    loaded,
)
from visuohaptic.io.yaml_files import check_config, check_spelling
from visuohaptic.base.atomic_files import atomic_write_text, storage_fault
from visuohaptic_workflow.blocks import divide
from visuohaptic_workflow.clocks import date_at_present
from visuohaptic_workflow.code_of_jobs import (
    CODE,
    STEP,
    Runs,
    code_of,
    files_beside,
    imports_of,
)
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
    make_python_a_shell_word,
    set_job_environment,
    without_studies_of_clones,
)
from visuohaptic_workflow.keys import Keys, read_record
from visuohaptic_workflow.one_run import (
    check_folder,
    check_writable,
    claim_folder,
    claim_results,
)
from visuohaptic_workflow.parameter_sources import (
    check_parameters,
    option_of_settings,
    options_of_values,
)
from visuohaptic_workflow.planning import (
    Declared,
    fill,
    plan_jobs,
    values_of_option,
)
from visuohaptic_workflow.progress import show_job_lines
from visuohaptic_workflow.records import PREFIX
from visuohaptic_workflow.sweeping import (
    MODEL_RECORDS,
    RECORDS,
    carry_out,
    find_former,
    is_at_hand,
    plan_sweep,
    stale_marker,
)
from visuohaptic_workflow.termination import (
    end_at_once,
    is_termination_received,
    pass_termination_on,
)
from visuohaptic_workflow.why import lines_of_sweep, verify, why

make_python_a_shell_word()
# The environment of the caller, for the process that writes DVC's lock.
ENVIRONMENT = {
    name: value
    for name, value in os.environ.items()
    if not name.startswith("VISUOHAPTIC_")
}
set_job_environment(*SOURCES)
sys.path[:] = [*without_studies_of_clones(sys.path), *map(str, STUDY_FOLDERS)]
# Whether keys decide which jobs run. Otherwise Snakemake's own metadata decide: in a storage, where records can't be
# read at the start, and in another workflow.
IS_KEYED = IS_MAIN and workflow.storage_settings.default_storage_provider is None
# Whether this process decides by keys which jobs run.
DECIDES = IS_KEYED and IS_PLANNER
DIGESTS = Digests(".cache/digests.json")
READ_IMPORTS = partial(DIGESTS.read_cached, imports_of)


def stop(sentence):
    """Print an error and exit; as a module of another workflow, raise `WorkflowError`."""
    if not IS_MAIN:
        raise WorkflowError(sentence)
    print(f"error: {sentence}", file=sys.stderr)
    sys.exit(1)


def or_stop(function, *arguments):
    """Call a function; on an error of this package or of a disk, `stop` with its message instead of a traceback."""
    try:
        return function(*arguments)
    except VisuohapticError as error:
        stop(error)
    except OSError as error:
        fault = storage_fault(error, error.filename or Path.cwd())
        if fault is None:
            raise
        stop(fault)


or_stop(check_folder, ROOT, Path.cwd())
if DECIDES:
    # Save even if no job runs; else the files of a new clone would be read again each time.
    atexit.register(DIGESTS.save)
    os.environ[PREFIX] = sys.prefix
    if set(values_of_option(sys.argv, "--rerun-triggers")) - {"mtime"}:
        stop(
            "--rerun-triggers allows only mtime here: keys decide which jobs run, and with other triggers Snakemake "
            "would run the same jobs each time."
        )
    if ASKED not in os.environ:
        or_stop(check_writable)
    if IN_STAGE in os.environ:
        or_stop(check_clone)
        make_empty_outputs()


def shipped(path):
    """Return the path of a file of the working folder, or else of the repository, relative to the working folder."""
    return path if Path(path).exists() else os.path.relpath(ROOT / path)


# The parameters of the working folder, or else of the repository.
configfile: shipped("params.yaml")


def parameters_of_run():
    """Check and return the parameters; an error names the files or the option that hold the wrong values."""
    settings = workflow.config_settings
    files = [shipped("params.yaml")] * (not settings.replace_workflow_config)
    files += [os.path.relpath(file) for file in settings.configfiles]
    if not IS_MAIN:
        return check_parameters(config, [], {"config of the module": config})
    return check_parameters(config, files, {SETTINGS: settings.config})


# A workflow that uses this workflow as a module checks its own configuration.
for file in workflow.configfiles if IS_MAIN else []:
    or_stop(check_spelling, file)
SETTINGS = option_of_settings(sys.argv)
OPTIONS = options_of_values(
    sys.argv,
    [os.path.relpath(file) for file in workflow.config_settings.configfiles],
    workflow.config_settings.config_args or (),
)
if IS_MAIN and IS_PLANNER:
    for setting in workflow.config_settings.config_args or ():
        or_stop(check_config, str(setting), SETTINGS)
# Load plug-ins before parameters are checked against registered names. Jobs load them when they import the package.
or_stop(load_installed)
or_stop(load_files, config.get("plugins", []))
for plug_in in loaded():
    if plug_in.file:
        or_stop(files_beside, plug_in.file)
load_in_child_processes()
PARAMETERS = or_stop(parameters_of_run)
CATALOGUED = {
    model.key: model
    for model in or_stop(
        models_of_set, shipped("meshes/catalogue.csv"), PARAMETERS.meshes.set
    )
}
OWN_MODELS = find_own_models("meshes/own", CATALOGUED)
OWN = {model.key: path for model, path in OWN_MODELS.models.items()}
COMPANIONS = companions(OWN.values())
# The process that writes DVC's lock would print the warnings of the run again.
if IS_PLANNER and os.environ.get(ASKED) != "lock":
    for sentence in OWN_MODELS.warnings:
        print(f"warning: {sentence}", file=sys.stderr)
DOWNLOADED = {
    key: model
    for key, model in CATALOGUED.items()
    if not Path(shipped(f"meshes/paper/{key}.ply.gz")).exists()
}
OBJECTS = sorted({**CATALOGUED, **OWN})
or_stop(check_objects, OBJECTS)
OBJECT_BLOCKS = divide(OBJECTS, PARAMETERS.workflow.objects_per_job)
# The viewpoints of each block, by names such as 00-15.
VIEW_BLOCKS = {}
for start in range(0, PARAMETERS.viewpoints.total, PARAMETERS.workflow.views_per_job):
    end = min(start + PARAMETERS.workflow.views_per_job, PARAMETERS.viewpoints.total)
    VIEW_BLOCKS[f"{start:02d}-{end - 1:02d}"] = list(range(start, end))
# Values of each wildcard. Rules in VALUES_OF_RULES list the wildcards of their jobs instead.
VALUES = {
    "objects": OBJECT_BLOCKS,
    "views": VIEW_BLOCKS,
    "pipeline": PARAMETERS.recognition.pipelines,
    "strategy": PARAMETERS.probing.strategies,
}
VALUES_OF_RULES = {}


# Regular expressions of wildcards.
CONSTRAINTS = {
    "objects": "[^/]+/[^/]+",
    "views": r"\d+-\d+",
    "pipeline": "[a-z_]+",
    "strategy": "[a-z_]+",
}
# Patterns of files of former jobs that fit no output of a rule of today, by rule.
FORMER_PATTERNS = {}


wildcard_constraints:
    **CONSTRAINTS,


def in_clone(files):
    """Mark files that no job makes as local, because they are not in the storage of the results."""
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
    """Return the size in cm and the rotation to upright of each object of a block; None for own models."""
    models = {key: CATALOGUED.get(key) for key in OBJECT_BLOCKS[wildcards.objects]}
    return {
        key: model and {"dimensions": model.dimensions, "rotation": model.rotation}
        for key, model in models.items()
    }


def blocks_with(objects):
    """List the names of the blocks that contain at least one of the objects."""
    return [
        name
        for name, block in OBJECT_BLOCKS.items()
        if not {*block}.isdisjoint(objects)
    ]


def meshes_of(objects=OBJECTS):
    """List the folders with the meshes of objects; the folders may contain further meshes."""
    return expand("results/meshes/{objects}", objects=blocks_with(objects))


def files_of(table, each="{objects}/{views}", suffix="parquet", **chosen):
    """List the files of a table: all values of the wildcards in `each`, or the values in `chosen`."""
    return expand(f"results/{table}/{each}.{suffix}", **{**VALUES, **chosen})


def views_of(table):
    """List patterns of the files of a table for all viewpoints of one block of objects."""
    return [f"results/{table}/{{objects}}/{views}.parquet" for views in VIEW_BLOCKS]


def places_of(files, **chosen):
    """List the files with probing locations, of strategies and policies; `files` is `files_of` or `views_of`."""
    return [*files("fixations", **chosen), *files("policy_fixations", **chosen)]


# Code and inputs of each rule.
DECLARED = {}
# Snapshots of the jobs of this run (`Keys.snapshot`), by record. Jobs on other machines read them from the file.
SNAPSHOTS_FILE = Path("logs/snapshots.json")
SNAPSHOTS = {}
# Records of the jobs that the targets of this run cover, whether they run or not.
COVERED = set()


def takes(name, script=None, own=(), **files_by_name):
    """Declare the code and inputs of a rule, and return its input function.

    Snakemake asks only whether the outputs of a job exist (`sweep`), so the times of inputs are ignored. `script` defaults
    to the name of the rule. `own` are modules outside of the library.
    """
    path = ROOT / "workflow/scripts" / (script or f"{name}.py")
    runs = Runs(path, CODE.get(name, STEP), tuple(own))
    DECLARED[name] = Declared(runs, files_by_name)

    def inputs(wildcards):
        files = DECLARED[name].files(wildcards)
        if not IS_KEYED:
            code = in_clone(map(os.path.relpath, find_code(runs).files))
            return {**files, "code": code}
        if not IS_PLANNER:
            return files
        record = fill(str(getattr(rules, name).output.record), wildcards)
        if record not in keys().jobs:
            values = ", ".join(f"{part} {value}" for part, value in wildcards.items())
            stop(
                f"rule {name} has no job for {values} with today's objects and parameters."
            )
        COVERED.add(record)
        if record not in sweep(MODEL_RECORDS if name == "model" else RECORDS).stale:
            return {part: inputs_of_current_job(item) for part, item in files.items()}
        SNAPSHOTS[record] = keys().snapshot(record)
        # A dry run moves nothing, so that the stale outputs exist.
        return files if is_run() else {**files, "stale": stale_marker()}

    return unpack(inputs)


def inputs_of_current_job(files):
    """Return the inputs of a current job so that none of them runs the job, whatever its time.

    Files that this run makes again are left out: Snakemake would run the job because such a file is missing.
    """
    if isinstance(files, str):
        return [] if files in files_to_make() else ancient(files)
    return [ancient(file) for file in files if file not in files_to_make()]


@cache
def files_to_make():
    """Return the outputs of all stale jobs."""
    return {
        file for record in sweep(RECORDS).stale for file in keys().jobs[record].outputs
    }


@cache
def claim():
    """Lock this folder for the run."""
    or_stop(claim_folder)


@cache
def sweep(records):
    """Return what is stale in this folder (`sweeping.Sweep`). A process that runs jobs moves stale files at once.

    `records` are the folders of the records of the jobs, `RECORDS` or `MODEL_RECORDS`: stale models stay until a target
    asks for a model. Snakemake calls the input functions of jobs, and so this function, before it looks for their files.
    """
    if workflow.touch:
        stop("--touch is refused here: keys decide which jobs run, not times.")
    if is_run():
        claim()
    names = [
        name for name in DECLARED if (name == "model") == (records == MODEL_RECORDS)
    ]
    patterns = [str(file) for name in names for file in getattr(rules, name).output]
    patterns += [file for name in names for file in FORMER_PATTERNS.get(name, ())]
    planned = or_stop(plan_sweep, keys(), records, patterns, CONSTRAINTS)
    if is_run():
        most_bytes = PARAMETERS.workflow.store_gigabytes * 1e9
        dated = or_stop(carry_out, planned, most_bytes)
        dated += or_stop(date_at_present, keys().inputs_of(planned.stale))
        if dated:
            print(
                f"{len(dated)} files were modified in the future, such as {dated[0]}; they now have the present time.",
                file=sys.stderr,
            )
    if workflow.executor_plugin is not None:
        left_out = studies_left_out(planned)
        for line in lines_of_sweep(planned, left_out, is_done=is_run()):
            print(line, file=sys.stderr)
    return planned


def is_run():
    """Return whether this process runs jobs or finds that none has to run, unlike a dry run or a question."""
    return workflow.executor_plugin is not None and not workflow.dryrun


def key_of_job(wildcards, output):
    """Return the snapshot of a job, with the parts of its key; None without keys."""
    if not IS_KEYED:
        return None
    if not IS_PLANNER:
        return json.loads(SNAPSHOTS_FILE.read_text(encoding="utf-8")).get(output.record)
    if output.record not in SNAPSHOTS:
        SNAPSHOTS[output.record] = keys().snapshot(output.record)
    return SNAPSHOTS[output.record]


@cache
def keys():
    """Return the keys of all jobs of the current parameters and objects."""
    jobs = [
        job
        for name, declared in DECLARED.items()
        for job in plan_jobs(
            name, declared, getattr(rules, name), VALUES_OF_RULES.get(name, VALUES)
        )
    ]
    return Keys(jobs, find_code, DIGESTS, ROOT, find_former)


@cache
def find_code(runs):
    """Find the code of a job, with plug-ins."""
    return code_of(runs, SOURCES, STUDY_FOLDERS, loaded(), READ_IMPORTS)


def all_cores(wildcards):
    """Return the number of cores for a job that must be the only running job; profiles of clusters set it to one."""
    return workflow.cores or 1


def words_of_job(message, wildcards):
    """Return what a job does: the message of its rule, with the objects of a block instead of its name."""
    name = wildcards.get("objects", "")
    block = OBJECT_BLOCKS.get(name, ())
    if len(block) < 2:
        return message
    more = "1 other" if len(block) == 2 else f"{len(block) - 1} others"
    return message.replace(name, f"{block[0]} and {more}", 1)


def report_at_end():
    """Return the path of the report if this run asks for the report, but not for a list of what would run."""
    asks = "results/records/report.json" in COVERED and is_run()
    return "reports/report.html" if asks else None


if DECIDES and ASKED not in os.environ:
    show_job_lines(logger, words_of_job, report_at_end)


def answer_make():
    """Answer `make why` or `make verify`, or write DVC's lock, and exit, if environment variable ASKED is set."""
    if not DECIDES or ASKED not in os.environ:
        return
    targets, is_fine = [*map(str, rules.all.input)], True
    if os.environ[ASKED] == "lock":
        or_stop(claim_results)
        or_stop(write_lock, keys(), targets, are_parameters_current, sweep(RECORDS))
        sys.exit()
    planned = sweep(RECORDS)
    lines = why(keys(), targets, planned, studies_left_out(planned))
    if os.environ[ASKED] == "verify":
        lines, is_fine = verify(keys(), sweep(RECORDS))
    print(*lines, sep="\n")
    sys.exit(not is_fine)


def start_run():
    """Write the snapshots of the jobs of this run, and let Snakemake select jobs only when a job has ended."""
    if not DECIDES:
        return
    pass_termination_on()
    limit = workflow.scheduling_settings.max_jobs_per_timespan
    is_default = limit is not None and (limit.max_jobs, limit.timespan) == (100, 1)
    if workflow.local_exec and is_default:
        # Snakemake's default limit of jobs per second starts a timer at each selection of jobs, and each job that ends adds
        # a selection (github.com/snakemake/snakemake/pull/3744): selections per second grow with the jobs of the run.
        workflow.scheduler.job_rate_limiter = None
    or_stop(atomic_write_text, SNAPSHOTS_FILE, json.dumps(SNAPSHOTS))


def close_run():
    """Print the results and warnings, and let DVC lock a complete run."""
    if not DECIDES:
        return
    # Imports Arrow, which a run without jobs does not need.
    from visuohaptic_workflow.closing import lines_at_end

    end_at_once()
    read = {record: read_record(record) for record in keys().jobs}
    current = {
        record
        for record, content in read.items()
        if content.get("key") == keys().key(record)
    }
    logs = [read[record]["log"] for record in sorted(COVERED) if "log" in read[record]]
    report_is_current = "results/records/report.json" in current
    for line in lines_at_end(logs, report_is_current=report_is_current):
        print(line, file=sys.stderr)
    or_stop(make_empty_outputs)
    if is_lockable() and not is_termination_received():
        lock(current)


def name_left_out():
    """After a failed run, print why objects were left out: recognition may lack them."""
    if DECIDES:
        from visuohaptic_workflow.closing import lines_of_left_out

        for line in lines_of_left_out():
            print(line, file=sys.stderr)


def are_parameters_current():
    """Return whether params.yaml still has the parameters of this process."""
    return read_parameters("params.yaml") == PARAMETERS


def lock(current):
    """Let DVC lock a complete run with the parameters of params.yaml; `current` are the records that are current."""
    if not or_stop(are_parameters_current):
        print(
            "dvc.lock stays as it was: this run's parameters are not those of params.yaml.",
            file=sys.stderr,
        )
        return
    needed = {*keys().needed_for(map(str, rules.all.input))}
    if needed - current:
        return
    print("DVC reads the results and writes dvc.lock.", file=sys.stderr)
    is_locked = lock_in_new_process({**ENVIRONMENT, ASKED: "lock"})
    if is_locked and not is_committed():
        print(
            "`git add dvc.lock && git commit -m Results` lets queued experiments start with these results.",
            file=sys.stderr,
        )
