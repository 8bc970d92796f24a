"""What the rules of studies share: conditions, their blocks, and what each job takes."""

from importlib.util import find_spec
from operator import attrgetter

from visuohaptic.studies.conditions import (
    describe_conditions,
    describe_study,
    make_blocks,
    plan_study,
)
from visuohaptic.studies.registry import find_studies
from visuohaptic.studies.sampling import sample_objects
from visuohaptic.studies.study import OF_CONDITIONS
from visuohaptic_workflow.studies_asked import names_rules_of, studies_asked_for

STUDIES = or_stop(find_studies, PARAMETERS, STUDY_FOLDERS)
PLANS = {
    name: or_stop(plan_study, study, PARAMETERS) for name, study in STUDIES.items()
}
BLOCKS = {
    name: make_blocks(plan, PARAMETERS.workflow.conditions_per_job)
    for name, plan in PLANS.items()
}
STUDIES_OF_RUN = [study for study in STUDIES.values() if study.is_part_of_run]
# Each step with its study; those of one name would be one rule.
STEPS = [(study, step) for study in STUDIES.values() for step in study.steps]
# With thousands of objects the sampled studies would take longer than all the rest.
SAMPLE = sample_objects(OBJECTS, PARAMETERS.cost.maximum_objects)


def some_of(objects, count):
    """Choose some objects, spread over all; for run times, or for what effects do, few are enough."""
    return objects[:: max(1, -(-len(objects) // count))]


# Jobs on other machines parse these files, too, and have other arguments.
if IS_PLANNER:
    os.environ.update(VISUOHAPTIC_ARGUMENTS=json.dumps(sys.argv[1:]))
ARGUMENTS = json.loads(os.environ.setdefault("VISUOHAPTIC_ARGUMENTS", "[]"))
ASKED_STUDIES = studies_asked_for(ARGUMENTS, STUDIES.values())
# Measured once, and left as they are.
KEPT_STUDIES = [
    study
    for study in STUDIES.values()
    if IS_KEYED
    and IS_PLANNER
    and not study.is_part_of_run
    and (study.is_on_request or not PARAMETERS.workflow.keep_studies_current)
    and study.name not in ASKED_STUDIES
    and Path(study.shown[0]).exists()
]

VALUES_OF_RULES["features_of_study"] = [
    {"study": name, "key": key}
    for name, plan in PLANS.items()
    for key in plan.recomputations
]
VALUES_OF_RULES["block_of_study"] = [
    {"study": name, "block": block}
    for name, blocks in BLOCKS.items()
    for block in blocks
]
VALUES_OF_RULES["figures_of_study"] = [
    {"study": study.name} for study in STUDIES.values() if study.has_figures
]
for study, step in STEPS:
    if "condition" in step.wildcards:
        VALUES_OF_RULES[step.name] = [
            {"condition": one.condition.name} for one in PLANS[study.name].conditions
        ]


def study_blocks(study):
    """List the files of a study's blocks, and of steps that count as blocks."""
    return [
        *(f"results/study_blocks/{study}/{block}.parquet" for block in BLOCKS[study]),
        *(
            file
            for step in STUDIES[study].steps
            if step.is_block
            for file in of_pipelines(step.files)
        ),
    ]


def of_pipelines(patterns):
    """List files, with those of each pipeline where they are of one."""
    return expand(patterns, pipeline=PARAMETERS.recognition.pipelines)


def recomputed_from(table, phases):
    """Give what lists the parts of a table for features that are recomputed from these phases on."""

    def files(wildcards):
        if recomputed_phase(wildcards) not in phases:
            return []
        objects = objects_of_study(wildcards.study)
        if table == "meshes":
            return meshes_of(objects)
        return parts_of(table, objects=objects)

    return files


def objects_of_study(study):
    """List the objects that a study measures."""
    return SAMPLE if STUDIES[study].is_sampled else OBJECTS


def sample_of_study(wildcards):
    """List the objects that a study takes of blocks that may hold more; nothing where it takes all."""
    return sample_of(wildcards.study)


def sample_of(study):
    """List the objects that a study takes of blocks that may hold more, by its name."""
    objects = objects_of_study(study)
    return None if objects == OBJECTS else objects


def recomputation_of(wildcards):
    """Give the features that a job recomputes."""
    return PLANS[wildcards.study].recomputations[wildcards.key]


def recomputed_phase(wildcards):
    """Give the first phase that a job recomputes."""
    return recomputation_of(wildcards).phase


def recomputation_parameters(wildcards):
    """Give the parameters with which a job recomputes features."""
    return recomputation_of(wildcards).parameters.model_dump(
        exclude={"workflow", "meshes", "cost", "gaze", "recognition"}
    )


def block_keys(wildcards):
    """Name the features of a block, those of the run left out."""
    block = BLOCKS[wildcards.study][wildcards.block]
    return sorted({one.key for one in block} - {None})


def made_features(study, keys):
    """List the files of features by their keys."""
    return [f"results/study_features/{study}/{key}.parquet" for key in keys]


def block_features(wildcards):
    """List the files of features that a block needs and the run does not have."""
    return made_features(wildcards.study, block_keys(wildcards))


def block_conditions(wildcards):
    """Give the conditions of a block."""
    return describe_conditions(BLOCKS[wildcards.study][wildcards.block])


def described_study(wildcards):
    """Give the description of a study for its figures."""
    return describe_study(STUDIES[wildcards.study], PLANS[wildcards.study])


def study_parts(wildcards):
    """List the files of a study's blocks."""
    return study_blocks(wildcards.study)


def own_features(wildcards):
    """List the run's own features for a block that needs them."""
    needed = any(one.key is None for one in BLOCKS[wildcards.study][wildcards.block])
    objects = objects_of_study(wildcards.study)
    return parts_of("features", objects=objects) if needed else []


def code_of_step(step):
    """Give the file that holds what a step does; with what it imports, it is the code of its job."""
    return Path(find_spec(step.work.partition(":")[0]).origin)


def sources_of_step(step):
    """List what a step's job runs beside its module: the script, and templates in a folder beside the module."""
    templates = sorted((code_of_step(step).parent / "templates").glob("*.*"))
    return in_clone(
        [shipped("workflow/scripts/study_step.py"), *map(os.path.relpath, templates)]
    )


def measured_objects(study, step):
    """List the objects whose meshes and fixations a step takes."""
    objects = objects_of_study(study.name)
    counts = {"timed": PARAMETERS.cost.objects, "two": 2}
    return some_of(objects, counts[step.objects]) if step.objects in counts else objects


def inputs_of_step(study, step):
    """Give what a step takes: files by name, or functions of its job's wildcards that list them."""
    if "condition" in step.wildcards:
        return {
            "features": lambda wildcards: (
                [] if keys_of_condition(study, wildcards) else parts_of("features")
            ),
            "made": lambda wildcards: made_features(
                study.name, keys_of_condition(study, wildcards)
            ),
        }
    measured = measured_objects(study, step)
    tables = {
        "meshes": lambda: meshes_of(measured),
        # Of the first viewpoints, which are enough.
        "fixations": lambda: parts_of(
            "fixations", objects=measured, views=view_blocks()[:1]
        ),
        "features": lambda: parts_of("features", objects=objects_of_study(study.name)),
        "blocks": lambda: study_blocks(study.name),
        "made": lambda: made_features(study.name, PLANS[study.name].recomputations),
    }
    found = {name: tables[name]() for name in step.takes if name in tables}
    others = [
        *(name for name in step.takes if name not in tables),
        *(
            file
            for name, file in step.takes_where.items()
            if attrgetter(name)(PARAMETERS)
        ),
    ]
    return {**found, **({"tables": of_pipelines(others)} if others else {})}


def condition_of(study, wildcards):
    """Give the planned condition of a job."""
    conditions = {one.condition.name: one for one in PLANS[study.name].conditions}
    return conditions[wildcards.condition]


def keys_of_condition(study, wildcards):
    """Name the features of a job's condition, unless they are the run's."""
    key = condition_of(study, wildcards).key
    return [] if key is None else [key]


def recomputed_for(study, step):
    """Give the keys of the features that a step's job takes, or a function of its wildcards that does."""
    if "condition" in step.wildcards:
        return lambda wildcards: keys_of_condition(study, wildcards)
    return list(PLANS[study.name].recomputations) if "made" in step.takes else []


def described_condition(study, step):
    """Give a function that describes the condition of a step's job; of other steps, nothing."""
    if "condition" not in step.wildcards:
        return None
    return lambda wildcards: describe_conditions([condition_of(study, wildcards)])[0]


# What the report shows beside the run itself, by file.
SHOWN_FILES = {
    file: study.name
    for study in STUDIES.values()
    if not study.is_part_of_run
    for file in study.shown
}


def is_shown(file, study):
    """Whether the report shows a file of a study: one that exists, or that this run makes."""
    is_made = file in ARGUMENTS or names_rules_of(ARGUMENTS, study)
    return is_made or Path(file).exists()


def shown_studies(wildcards):
    """Say by which keys the report knows that a study is of today's state."""
    shown = {}
    for file, study in SHOWN_FILES.items() if IS_KEYED else ():
        if is_shown(file, study):
            figures = STUDIES[study].shown[0]
            found = shown.setdefault(study, {"figures": figures, "keys": {}})
            found["keys"] |= {
                record: keys().key(record) for record in keys().makers([file])
            }
    return shown


def keep_studies():
    """Name the records of studies that are left as they are."""
    KEPT_RECORDS.update(
        job.record
        for job in (planned_jobs() if KEPT_STUDIES else [])
        if any(study.owns(job.outputs[0]) for study in KEPT_STUDIES)
    )


def report_of_study(wildcards):
    """List the report, which shows a study; in DVC it has a stage of its own."""
    return [] if "DVC_STAGE" in os.environ else rules.report_all.input
