"""Shared by the rules of studies: conditions, their blocks, and inputs of jobs."""

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

# Jobs on other machines parse these files with other arguments, so hand over the arguments of the planning process.
if IS_PLANNER:
    os.environ.update(VISUOHAPTIC_ARGUMENTS=json.dumps(sys.argv[1:]))
ARGUMENTS = json.loads(os.environ.setdefault("VISUOHAPTIC_ARGUMENTS", "[]"))
STUDIES = or_stop(find_studies, PARAMETERS, STUDY_FOLDERS)
if IS_MAIN and IS_PLANNER:
    moved = find_moved(sys.argv[1:], STUDIES)
    if moved:
        stop(moved)
# Planning hundreds of conditions takes time, so plan only studies that need rules. As a module, plan all studies: the
# requested rules are unknown.
if IS_MAIN:
    STUDIES = studies_to_plan([*ARGUMENTS, *sys.argv[1:]], STUDIES)
PLANS = {
    name: or_stop(plan_study, study, PARAMETERS) for name, study in STUDIES.items()
}
STUDIES_OF_RUN = [study for study in STUDIES.values() if study.is_part_of_run]
# Each step with its study; the names of steps are unique.
STEPS = [(study, step) for study in STUDIES.values() for step in study.steps]
# The objects of sampled studies, which would take longest with thousands of objects.
SAMPLE = sample_objects(OBJECTS, PARAMETERS.cost.maximum_objects)


def takes_predictions(study):
    """Return whether a study uses the run's predictions: only if it measures all objects and a step takes them."""
    return any("predictions" in step.takes for step in study.steps) and (
        SAMPLE == OBJECTS or not study.is_sampled
    )


def conditions_to_measure(study):
    """Return the plan of a study without the conditions that the run measures."""
    plan = PLANS[study.name]
    if not takes_predictions(study):
        return plan
    remaining = [
        planned
        for planned in plan.conditions
        if not is_measured_by_run(planned, PARAMETERS)
    ]
    return replace(plan, conditions=tuple(remaining))


BLOCKS = {
    study.name: make_blocks(
        conditions_to_measure(study), PARAMETERS.workflow.conditions_per_job
    )
    for study in STUDIES.values()
}

# Studies whose existing files are kept even if they are not current.
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
            {"condition": planned.condition.name}
            for planned in PLANS[study.name].conditions
        ]
        for study, step in STEPS
        if "condition" in step.wildcards
    },
}


def study_blocks(study):
    """List the files of a study's blocks, and of its steps with `is_block`."""
    steps = (step for step in STUDIES[study].steps if step.is_block)
    return [
        *(f"results/study_blocks/{study}/{block}.parquet" for block in BLOCKS[study]),
        *(file for step in steps for file in of_pipelines(step.files)),
    ]


def of_pipelines(patterns):
    """Fill wildcard ``pipeline`` of file patterns with all pipelines; other files are unchanged."""
    return expand(patterns, pipeline=PARAMETERS.recognition.pipelines)


def objects_of(study):
    """List the objects that a study measures."""
    return SAMPLE if STUDIES[study].is_sampled else OBJECTS


def sample_of(study):
    """Return the objects of a sampled study, or None if the study measures all objects."""
    return None if objects_of(study) == OBJECTS else objects_of(study)


def recomputation_of(wildcards):
    """Return the recomputation of a job."""
    return PLANS[wildcards.study].recomputations[wildcards.key]


# Tables, and the meshes, that recomputations may need.
NEEDED = dict.fromkeys(
    name for phase in OF_OBJECT for name in inputs_needed_from(next(iter(phase.writes)))
)


def needed_by_recomputation(table):
    """Return an input function that lists the files of a table, or the meshes, if the job's recomputation needs them."""

    def files(wildcards):
        if table not in inputs_needed_from(recomputation_of(wildcards).phase):
            return []
        objects = objects_of(wildcards.study)
        if table == "meshes":
            return meshes_of(objects)
        return files_of(table, objects=blocks_with(objects))

    return files


def recomputation_parameters(wildcards):
    """Return the parameters with which a job recomputes features."""
    return recomputation_of(wildcards).parameters.model_dump(
        exclude={**WITHOUT_EFFECT, "recognition": True}
    )


def conditions_of(wildcards, study=None):
    """List the conditions of a job: of its block, or of its step if `study` is given."""
    if study is None:
        return BLOCKS[wildcards.study][wildcards.block]
    return [
        planned
        for planned in PLANS[study].conditions
        if planned.condition.name == wildcards.condition
    ]


def keys_of(wildcards, study=None):
    """List the keys of the recomputed features of a job's conditions."""
    return sorted({planned.key for planned in conditions_of(wildcards, study)} - {None})


def features_of(study):
    """List the files of the run's features for a study's objects."""
    return files_of("features", objects=blocks_with(objects_of(study)))


def made_features(study, keys):
    """List the files of recomputed features by key."""
    return [f"results/study_features/{study}/{key}.parquet" for key in keys]


def features_for(study=None):
    """Return input functions for the features of a job's conditions: of the run if needed, and recomputed."""

    def own(wildcards):
        is_needed = None in {planned.key for planned in conditions_of(wildcards, study)}
        return features_of(study or wildcards.study) if is_needed else []

    def made(wildcards):
        return made_features(study or wildcards.study, keys_of(wildcards, study))

    return {"features": own, "made": made}


def own_code_of(step):
    """List the module of a step, if it is outside of the library."""
    file = Path(find_spec(step.work.partition(":")[0]).origin)
    return [] if file.is_relative_to(SOURCES[0]) else [file]


def measured_objects(study, step):
    """List the objects whose meshes and fixations a step takes: all, or evenly spaced objects if few suffice."""
    objects = objects_of(study.name)
    counts = {"timed": PARAMETERS.cost.objects, "two": 2}
    count = counts.get(step.objects, len(objects) or 1)
    return objects[:: max(1, -(-len(objects) // count))]


def inputs_of_step(study, step):
    """Return the inputs of a step: files by name, or functions of wildcards that list them."""
    if "condition" in step.wildcards:
        return features_for(study.name)
    measured = measured_objects(study, step)
    available = {
        "meshes": meshes_of(measured),
        # The first block of viewpoints is enough.
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
    available["tables"] = of_pipelines(
        [
            *(name for name in step.takes if name not in available),
            *(file for name, file in where if attrgetter(name)(PARAMETERS)),
        ]
    )
    names = (*step.takes, *(["tables"] if available["tables"] else []))
    return {name: available[name] for name in names if name in available}


def params_of_step(study, step):
    """Return the params of a step's job, without its key."""
    params = {
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
        params["measured"] = measured_objects(study, step)
    if "made" in step.takes:
        params["recomputed"] = list(PLANS[study.name].recomputations)
    if "condition" in step.wildcards:
        params["recomputed"] = lambda wildcards: keys_of(wildcards, study.name)
        params["condition"] = lambda wildcards: describe_conditions(
            conditions_of(wildcards, study.name)
        )[0]
    return params


# Files of further studies that the report shows, by file: they exist, or this run makes them.
SHOWN_FILES = {
    file: study
    for study in STUDIES.values()
    if not study.is_part_of_run
    for file in study.shown
    if file in ARGUMENTS or names_rules_of(ARGUMENTS, study.name) or Path(file).exists()
}


def shown_studies(wildcards):
    """Return the file of figures and the current keys of each shown study, to find studies that are not current."""
    shown = {}
    for file, study in SHOWN_FILES.items() if IS_KEYED else ():
        figures = {"figures": study.shown[0], "keys": {}}
        shown.setdefault(study.name, figures)["keys"] |= {
            record: keys().key(record) for record in keys().makers([file])
        }
    return shown


def report_of_study(wildcards):
    """List the files of the report, which shows a study; none in a stage of DVC."""
    return [] if "DVC_STAGE" in os.environ else rules.report_all.input
