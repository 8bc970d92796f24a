"""What the rules of studies share: conditions, their blocks, and what each job takes."""

from dataclasses import replace
from importlib.util import find_spec
from operator import attrgetter

from visuohaptic.studies.conditions import (
    describe_conditions,
    describe_study,
    is_measured_by_run,
    make_blocks,
    plan_study,
)
from visuohaptic.studies.registry import find_studies, section_files
from visuohaptic.studies.sampling import sample_objects
from visuohaptic.studies.study import DUMP_FOR_CONDITIONS, WITHOUT_EFFECT
from visuohaptic_workflow.studies_asked import (
    find_moved,
    is_asked_for,
    names_rules_of,
    studies_to_plan,
)

# Jobs on other machines parse these files, too, and have other arguments.
if IS_PLANNER:
    os.environ.update(VISUOHAPTIC_ARGUMENTS=json.dumps(sys.argv[1:]))
ARGUMENTS = json.loads(os.environ.setdefault("VISUOHAPTIC_ARGUMENTS", "[]"))
STUDIES = or_stop(find_studies, PARAMETERS, STUDY_FOLDERS)
if IS_MAIN and IS_PLANNER:
    moved = find_moved(sys.argv[1:], STUDIES)
    if moved:
        stop(moved)
# Hundreds of conditions take time to plan. Which rules another workflow takes of its module is not known.
if IS_MAIN:
    STUDIES = studies_to_plan([*ARGUMENTS, *sys.argv[1:]], STUDIES)
PLANS = {
    name: or_stop(plan_study, study, PARAMETERS) for name, study in STUDIES.items()
}
STUDIES_OF_RUN = [study for study in STUDIES.values() if study.is_part_of_run]
# Each step with its study; those of one name would be one rule.
STEPS = [(study, step) for study in STUDIES.values() for step in study.steps]
# With thousands of objects the sampled studies would take longer than all the rest.
SAMPLE = sample_objects(OBJECTS, PARAMETERS.cost.maximum_objects)


def takes_predictions(study):
    """Say whether the run's predictions stand for a study's conditions: not where it measures a part of the objects."""
    return any("predictions" in step.takes for step in study.steps) and (
        SAMPLE == OBJECTS or not study.is_sampled
    )


def conditions_to_measure(study):
    """Plan the conditions of a study that the run itself did not measure."""
    plan = PLANS[study.name]
    if not takes_predictions(study):
        return plan
    left = [one for one in plan.conditions if not is_measured_by_run(one, PARAMETERS)]
    return replace(plan, conditions=tuple(left))


BLOCKS = {
    study.name: make_blocks(
        conditions_to_measure(study), PARAMETERS.workflow.conditions_per_job
    )
    for study in STUDIES.values()
}

# Measured once, and left as they are.
KEPT_STUDIES = [
    study
    for study in STUDIES.values()
    if DECIDES
    and not study.is_part_of_run
    and (study.is_on_request or not PARAMETERS.workflow.keep_studies_current)
    and not is_asked_for(ARGUMENTS, study)
    and Path(study.shown[0]).exists()
]

VALUES_OF_RULES |= {
    "features_of_study": [
        {"study": name, "key": key}
        for name, plan in PLANS.items()
        for key in plan.recomputations
    ],
    "block_of_study": [
        {"study": name, "block": block}
        for name, blocks in BLOCKS.items()
        for block in blocks
    ],
    "figures_of_study": [
        {"study": study.name} for study in STUDIES.values() if study.has_figures
    ],
    **{
        step.name: [
            {"condition": one.condition.name} for one in PLANS[study.name].conditions
        ]
        for study, step in STEPS
        if "condition" in step.wildcards
    },
}


def study_blocks(study):
    """List the files of a study's blocks, and of steps that count as blocks."""
    steps = (step for step in STUDIES[study].steps if step.is_block)
    return [
        *(f"results/study_blocks/{study}/{block}.parquet" for block in BLOCKS[study]),
        *(file for step in steps for file in of_pipelines(step.files)),
    ]


def of_pipelines(patterns):
    """List files, with those of each pipeline where they are of one."""
    return expand(patterns, pipeline=PARAMETERS.recognition.pipelines)


def objects_of(study):
    """List the objects that a study measures."""
    return SAMPLE if STUDIES[study].is_sampled else OBJECTS


def sample_of(study):
    """List the objects that a study takes of blocks that may hold more; nothing where it takes all."""
    return None if objects_of(study) == OBJECTS else objects_of(study)


def recomputation_of(wildcards):
    """Give the features that a job recomputes."""
    return PLANS[wildcards.study].recomputations[wildcards.key]


# What features may be recomputed from, whatever the first phase.
NEEDED = dict.fromkeys(
    name for one in OF_OBJECT for name in inputs_needed_from(next(iter(one.writes)))
)


def needed_by_recomputation(table):
    """Give what lists the parts of a table, or the meshes, where a job recomputes features from it."""

    def files(wildcards):
        if table not in inputs_needed_from(recomputation_of(wildcards).phase):
            return []
        objects = objects_of(wildcards.study)
        if table == "meshes":
            return meshes_of(objects)
        return files_of(table, objects=blocks_with(objects))

    return files


def recomputation_parameters(wildcards):
    """Give the parameters with which a job recomputes features."""
    return recomputation_of(wildcards).parameters.model_dump(
        exclude={**WITHOUT_EFFECT, "recognition": True}
    )


def conditions_of(wildcards, study=None):
    """List the conditions of a job: those of its block, or the one of a study's step."""
    if study is None:
        return BLOCKS[wildcards.study][wildcards.block]
    conditions = PLANS[study].conditions
    return [one for one in conditions if one.condition.name == wildcards.condition]


def keys_of(wildcards, study=None):
    """Name the features that a job's conditions need and the run does not have."""
    return sorted({one.key for one in conditions_of(wildcards, study)} - {None})


def features_of(study):
    """List the run's own features of a study's objects."""
    return files_of("features", objects=blocks_with(objects_of(study)))


def made_features(study, keys):
    """List the files of features by their keys."""
    return [f"results/study_features/{study}/{key}.parquet" for key in keys]


def features_for(study=None):
    """Give what lists the features of a job's conditions: the run's own, where one needs them, and others."""

    def own(wildcards):
        is_needed = any(one.key is None for one in conditions_of(wildcards, study))
        return features_of(study or wildcards.study) if is_needed else []

    def made(wildcards):
        return made_features(study or wildcards.study, keys_of(wildcards, study))

    return {"features": own, "made": made}


def own_code_of(step):
    """List the file that holds what a step does, where it lies outside of the library."""
    file = Path(find_spec(step.work.partition(":")[0]).origin)
    return [] if file.is_relative_to(SOURCES[0]) else [file]


def measured_objects(study, step):
    """List the objects whose meshes and fixations a step takes: where few are enough, some that are spread over all."""
    objects = objects_of(study.name)
    counts = {"timed": PARAMETERS.cost.objects, "two": 2}
    count = counts.get(step.objects, len(objects) or 1)
    return objects[:: max(1, -(-len(objects) // count))]


def inputs_of_step(study, step):
    """Give what a step takes: files by name, or functions of its job's wildcards that list them."""
    if "condition" in step.wildcards:
        return features_for(study.name)
    measured = measured_objects(study, step)
    found = {
        "meshes": meshes_of(measured),
        # Of the first viewpoints, which are enough.
        "fixations": places_of(
            files_of, objects=blocks_with(measured), views=[*VIEW_BLOCKS][:1]
        ),
        "features": features_of(study.name),
        "blocks": study_blocks(study.name),
        "made": made_features(study.name, PLANS[study.name].recomputations),
        "predictions": (
            files_of("predictions", "{pipeline}/{strategy}")
            if takes_predictions(study)
            else []
        ),
    }
    where = step.takes_where.items()
    found["tables"] = of_pipelines(
        [
            *(name for name in step.takes if name not in found),
            *(file for name, file in where if attrgetter(name)(PARAMETERS)),
        ]
    )
    names = (*step.takes, *(["tables"] if found["tables"] else []))
    return {name: found[name] for name in names if name in found}


def params_of_step(study, step):
    """Give what a step's job is told, but for its key."""
    told = {
        "study": study.name,
        "work": step.work,
        "inputs": list(inputs_of_step(study, step)),
        "files": len(step.files),
        "parameters": PARAMETERS.model_dump(**step.needs),
        "measured": None,
        "sample": sample_of(study.name),
        "recomputed": [],
        "condition": None,
    }
    if {"meshes", "fixations"} & {*step.takes}:
        told["measured"] = measured_objects(study, step)
    if "made" in step.takes:
        told["recomputed"] = list(PLANS[study.name].recomputations)
    if "condition" in step.wildcards:
        told["recomputed"] = lambda wildcards: keys_of(wildcards, study.name)
        told["condition"] = lambda wildcards: describe_conditions(
            conditions_of(wildcards, study.name)
        )[0]
    return told


# What the report shows beside the run itself: files that exist, or that this run makes, with their studies.
SHOWN_FILES = {
    file: study
    for study in STUDIES.values()
    if not study.is_part_of_run
    for file in study.shown
    if file in ARGUMENTS or names_rules_of(ARGUMENTS, study.name) or Path(file).exists()
}


def shown_studies(wildcards):
    """Say by which keys the report knows that a study is of today's state."""
    shown = {}
    for file, study in SHOWN_FILES.items() if IS_KEYED else ():
        figures = {"figures": study.shown[0], "keys": {}}
        shown.setdefault(study.name, figures)["keys"] |= {
            record: keys().key(record) for record in keys().makers([file])
        }
    return shown


def report_of_study(wildcards):
    """List the report, which shows a study; a stage of DVC for a study leaves it alone."""
    return [] if "DVC_STAGE" in os.environ else rules.report_all.input
