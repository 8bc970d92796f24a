"""Shared by all rules: parameters, objects, blocks of viewpoints, and code as input."""

import json
import os
import platform
import sys
from functools import cache
from pathlib import Path

# This file's own place: the folder of the Snakefile that was called may be another workflow's.
ROOT = Path(os.path.abspath(sys._getframe().f_code.co_filename)).parents[2]
SOURCES = [ROOT / "src", ROOT / "packages/contourlets/src", ROOT / "workflow/lib"]
# Where the user's studies lie: in the working folder, and in the clone.
STUDY_FOLDERS = [Path("studies").absolute(), ROOT / "studies"]
sys.path[:0] = map(str, SOURCES)
sys.path += map(str, STUDY_FOLDERS)

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
    check_config,
    check_spelling,
)
from visuohaptic.pipeline import OF_OBJECT, phase as phase_of
from visuohaptic.plugins import hand_on, load_files, load_installed, loaded
from visuohaptic.whole_files import write_whole
from visuohaptic_workflow.blocks import divide
from visuohaptic_workflow.closing import lines_at_end
from visuohaptic_workflow.closure import Start, code_of, with_plug_ins
from visuohaptic_workflow.digests import Digests
from visuohaptic_workflow.jobs import set_job_environment
from visuohaptic_workflow.keys import Keys, read_record
from visuohaptic_workflow.leftovers import put_aside
from visuohaptic_workflow.markers import mark_stale
from visuohaptic_workflow.one_run import (
    check_writable,
    claim_folder,
    is_claimed_by_another,
)
from visuohaptic_workflow.planning import (
    Declared,
    fill,
    plan_jobs,
    values_of_option,
)
from visuohaptic_workflow.records import PREFIX
from visuohaptic_workflow.why import ASKED, answer

set_job_environment(*SOURCES)
# Another workflow that uses this one as a module decides by its own means.
IS_MAIN = Path(workflow.main_snakefile).parent in (ROOT, ROOT / "workflow")
# A job on another machine parses this file, too, and takes over what the run was planned with.
HERE = f"{platform.node()}:{os.getpid()}"
IS_PLANNER = os.environ.setdefault("VISUOHAPTIC_RUN", HERE) == HERE
# In a storage, where records can't be read at the start, and in another workflow, Snakemake's own memory decides.
IS_KEYED = IS_MAIN and workflow.storage_settings.default_storage_provider is None
if IS_KEYED and IS_PLANNER:
    os.environ[PREFIX] = sys.prefix
    if set(values_of_option(sys.argv, "--rerun-triggers")) - {"mtime"}:
        raise WorkflowError(
            "Keys decide what runs here, and Snakemake's other reasons would run it again for ever: "
            "leave out --rerun-triggers, or say --rerun-triggers mtime."
        )
DIGESTS = Digests(".cache/digests.json")

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


if IS_KEYED and IS_PLANNER and ASKED not in os.environ:
    or_stop(check_writable)


def shipped(path):
    """Give the path of a file or folder of the repository, relative to the working folder."""
    if Path(path).exists():
        return path
    return os.path.relpath(ROOT / path)


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
hand_on()
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


# What each rule runs and takes; planned_jobs() reads it.
DECLARED = {}
# Rules that list their jobs' wildcards.
VALUES_OF_RULES = {}
# Records of studies that are left as they are.
KEPT_RECORDS = set()
# What the jobs of this run are given: in the process that plans it, and in those of other machines, which read it.
GIVEN_FILE = Path("logs/given.json")
GIVEN = {}


def takes(name, script, check=None, runs=(), chosen=(), **inputs):
    """Declare what a rule runs and takes; give its input, files whose times count for nothing where its record fits.

    The script `runs` modules of which it does not know; of registries the entries count that are `chosen`.
    """
    start = Start(ROOT / "workflow/scripts" / script, tuple(runs), tuple(chosen))
    DECLARED[name] = Declared(start, inputs)

    def chosen(wildcards):
        if check is not None:
            check()
        files = DECLARED[name].files(wildcards)
        if not IS_KEYED:
            return {**files, "code": code_of_rule(name)}
        record = fill(str(getattr(rules, name).output.record), wildcards)
        if not IS_PLANNER:
            return files
        reason = None if record in KEPT_RECORDS else keys().reason(record)
        if reason is None:
            return {part: keep_times_out(item) for part, item in files.items()}
        GIVEN[record] = keys().given(record)
        if is_another_run_at_work():  # which makes it, or will be waited for
            return files
        marker = or_stop(mark_stale, record, reason)
        return {**files, "why": [*marker, *sorted(keys().stale_behind(record))]}

    return unpack(chosen)


@cache
def is_another_run_at_work():
    """Whether another process makes results in this folder, as at a dry run beside it."""
    return is_claimed_by_another()


def keep_times_out(item):
    """Mark files whose times say nothing."""
    return ancient(item) if isinstance(item, str) else [ancient(file) for file in item]


def code_of_rule(name):
    """List the files of code that a rule runs, as inputs."""
    return in_clone(
        os.path.relpath(file) for file in find_code(DECLARED[name].start).files
    )


def key_of_rule(name):
    """Give what tells a job its key, and what it was planned with."""

    def given(wildcards):
        if not IS_KEYED:
            return None
        record = fill(str(getattr(rules, name).output.record), wildcards)
        if not IS_PLANNER:
            return json.loads(GIVEN_FILE.read_text(encoding="utf-8")).get(record)
        return GIVEN.setdefault(record, keys().given(record))

    return given


@cache
def keys():
    """Give the keys of all jobs that today's parameters and objects ask for."""
    return Keys(planned_jobs(), find_code, DIGESTS, ROOT, KEPT_RECORDS)


@cache
def find_code(start):
    """Find what a job runs, plug-ins among it."""
    sources = (*SOURCES, *(folder for folder in STUDY_FOLDERS if folder.is_dir()))
    return with_plug_ins(code_of(start, sources), loaded(), sources)


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
    """Give the number of cores for a job that must run alone; profiles of clusters set it to one."""
    return workflow.cores or 1


@cache
def planned_jobs():
    """List the jobs of all rules that today's parameters and objects ask for."""
    values = {
        "objects": OBJECT_BLOCKS,
        "views": view_blocks(),
        "pipeline": PARAMETERS.recognition.pipelines,
        "strategy": PARAMETERS.probing.strategies,
    }
    return [
        job
        for name, declared in DECLARED.items()
        for job in plan_jobs(
            name, declared, getattr(rules, name), VALUES_OF_RULES.get(name, values)
        )
    ]


def answer_why():
    """Say why jobs would run, if `make why` or `make verify` asks."""
    if IS_KEYED and IS_PLANNER:
        answer(keys(), map(str, rules.all.input))


def claim():
    """Allow one run at a time in this folder, and say what its jobs were planned with."""
    if IS_KEYED and IS_PLANNER:
        or_stop(claim_folder)
        write_whole(GIVEN_FILE, json.dumps(GIVEN))
        DIGESTS.save()


def check_recognition():
    """Stop before the first job where recognition is asked for and has no classes to tell apart."""
    or_stop(check_classes, OBJECTS)


FRONTIER_FOLDERS = (
    "study_features",
    "study_blocks",
    "records/features_of_study",
    "records/block_of_study",
)


def close_run():
    """Put aside what is no longer named, and say what was left out, what is of an earlier state, and what the report holds, once it is today's."""
    if not (IS_KEYED and IS_PLANNER):
        return
    # Outputs of a stage of DVC, which a frontier without features or settings does not make.
    for folder in FRONTIER_FOLDERS:
        Path("results", folder, "frontier").mkdir(parents=True, exist_ok=True)
    kept = {record: read_record(record).get("key") for record in keys().jobs}
    earlier = [
        record for record, key in kept.items() if key not in (None, keys().key(record))
    ]
    page = "results/records/report.json"
    is_whole = kept[page] == keys().key(page)
    named = {file for job in planned_jobs() for file in job.outputs}
    moved = put_aside(named) if is_whole else None
    for line in [
        *([moved] if moved else []),
        *(
            [
                f"{len(earlier)} records are of an earlier state: `make verify` lists them."
            ]
            if earlier
            else []
        ),
        *lines_at_end(report_is_current=is_whole),
    ]:
        print(line, file=sys.stderr)
