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
from visuohaptic.studies.study import WITHOUT_EFFECT
from visuohaptic_workflow.studies_asked import (
    asked_by_rule,
    names_of_run,
    say_faults,
    say_left_out,
    studies_to_plan,
)

# Jobs on other machines parse these files with other arguments, so hand over the arguments of the planning process.
if IS_PLANNER:
    os.environ.update(VISUOHAPTIC_ARGUMENTS=json.dumps(sys.argv[1:]))
ARGUMENTS = json.loads(os.environ.setdefault("VISUOHAPTIC_ARGUMENTS", "[]"))
STUDIES, FAULTS = or_stop(find_studies, PARAMETERS, STUDY_FOLDERS)
for sentence in or_stop(
    say_faults,
    FAULTS,
    STUDIES.values(),
    [*ARGUMENTS, *sys.argv[1:]],
    PARAMETERS.workflow.studies,
):
    if IS_PLANNER and os.environ.get(ASKED) != "lock":
        print(f"warning: {sentence}", file=sys.stderr)
OF_RUN = or_stop(names_of_run, STUDIES, PARAMETERS.workflow.studies)
# Planning hundreds of conditions takes time, so plan only studies that need rules. As a module, plan all studies: the
# requested rules are unknown.
if IS_MAIN:
    STUDIES = studies_to_plan([*ARGUMENTS, *sys.argv[1:]], STUDIES, OF_RUN)
PLANS = {
    name: or_stop(plan_study, study, PARAMETERS) for name, study in STUDIES.items()
}
STUDIES_OF_RUN = [study for study in STUDIES.values() if study.name in OF_RUN]
MORE_STUDIES = [study for study in STUDIES.values() if study.name not in OF_RUN]
# Each step with its study; the names of steps are unique.
STEPS = [(study, step) for study in STUDIES.values() for step in study.steps]
# Studies that would take very long with thousands of objects (`is_sampled`) measure only these objects.
SAMPLE = sample_objects(OBJECTS, PARAMETERS.cost.maximum_objects)


def takes_predictions(study):
    """Return whether a study reads the run's predictions: a step takes them, and the study measures all objects."""
    return any("predictions" in step.inputs for step in study.steps) and (
        SAMPLE == OBJECTS or not study.is_sampled
    )


def plan_to_measure(study):
    """Return a study's `Plan`; if the study reads the run's predictions, without conditions that the run measures."""
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
        plan_to_measure(study), PARAMETERS.workflow.conditions_per_job
    )
    for study in STUDIES.values()
}

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


def files_of_study(study_name):
    """List all files of a study: of its steps and figures, of blocks of conditions, and of recomputed features.

    Every file is listed, so that Snakemake makes a lost one again although the figures exist.
    """
    return [
        *STUDIES[study_name].targets,
        *study_blocks(study_name),
        *recomputed_features(study_name, PLANS[study_name].recomputations),
    ]


def study_blocks(study_name):
    """List the files with the measured conditions of a study: of its blocks, and of its steps with `is_block`."""
    steps = (step for step in STUDIES[study_name].steps if step.is_block)
    return [
        *(
            f"results/study_blocks/{study_name}/{block}.parquet"
            for block in BLOCKS[study_name]
        ),
        *(file for step in steps for file in of_pipelines(step.files)),
    ]


def of_pipelines(patterns):
    """List the files of patterns: with wildcard ``{pipeline}`` one per pipeline; other patterns are unchanged."""
    return expand(patterns, pipeline=PARAMETERS.recognition.pipelines)


def objects_of(study_name):
    """List the objects, ``class/name``, that a study measures."""
    return SAMPLE if STUDIES[study_name].is_sampled else OBJECTS


def sample_of(study_name):
    """Return the objects that a study measures; None if it measures all objects of the run."""
    objects = objects_of(study_name)
    return None if objects == OBJECTS else objects


def recomputation_of(wildcards):
    """Return the `Recomputation` of a job with wildcards ``study`` and ``key``."""
    return PLANS[wildcards.study].recomputations[wildcards.key]


# Names of the inputs that a recomputation may need: tables of the run, and "meshes".
NEEDED = dict.fromkeys(
    name for phase in OF_OBJECT for name in inputs_needed_from(next(iter(phase.writes)))
)


def needed_by_recomputation(name):
    """Return an input function that lists the files of an input in `NEEDED`, if the job needs this input."""

    def files(wildcards):
        if name not in inputs_needed_from(recomputation_of(wildcards).phase):
            return []
        objects = objects_of(wildcards.study)
        if name == "meshes":
            return meshes_of(objects)
        return files_of(name, objects=blocks_with(objects))

    return files


def recomputation_parameters(wildcards):
    """Return the parameters of a job that recomputes features: a dict without `WITHOUT_EFFECT` and ``recognition``."""
    return recomputation_of(wildcards).parameters.model_dump(
        exclude={**WITHOUT_EFFECT, "recognition": True}
    )


def conditions_of(wildcards, study_name=None):
    """List the conditions (`Planned`) that a job measures.

    Without `study_name`, these are the conditions of wildcards ``study`` and ``block``. Jobs of a step have no wildcard
    ``study``: with `study_name`, the list has the one condition of wildcard ``condition``.
    """
    if study_name is None:
        return BLOCKS[wildcards.study][wildcards.block]
    return [
        planned
        for planned in PLANS[study_name].conditions
        if planned.condition.name == wildcards.condition
    ]


def recomputed_keys(wildcards, study_name=None):
    """List the keys of the recomputed features that a job reads, sorted; arguments as in `conditions_of`."""
    return sorted(
        {planned.key for planned in conditions_of(wildcards, study_name)} - {None}
    )


def run_features(study_name):
    """List the files of the run's features that contain the objects of a study."""
    return files_of("features", objects=blocks_with(objects_of(study_name)))


def recomputed_features(study_name, keys):
    """List the files of a study's recomputed features, one per key of `Plan.recomputations`."""
    return [f"results/study_features/{study_name}/{key}.parquet" for key in keys]


def features_for(study_name=None):
    """Return two input functions by name of input, for jobs that measure conditions.

    ``features`` lists files of the run, if any condition of the job uses the run's features. ``recomputed_features``
    lists further files. `study_name` is needed only for a step with wildcard ``condition``.
    """

    def of_run(wildcards):
        used = {planned.key for planned in conditions_of(wildcards, study_name)}
        return run_features(study_name or wildcards.study) if None in used else []

    def recomputed(wildcards):
        keys_used = recomputed_keys(wildcards, study_name)
        return recomputed_features(study_name or wildcards.study, keys_used)

    return {"features": of_run, "recomputed_features": recomputed}


def user_code_of(step):
    """List the file of a step's module if the file is outside of the library; otherwise return an empty list."""
    file = Path(find_spec(step.work.partition(":")[0]).origin)
    return [] if file.is_relative_to(SOURCES[0]) else [file]


def measured_objects(study, step):
    """List the study's objects with meshes and fixations that a step reads.

    These are all objects of the study. Only if `Step.objects` is ``two`` or ``timed``, these are at most 2 or
    `cost.objects` evenly spaced objects.
    """
    objects = objects_of(study.name)
    counts = {"timed": PARAMETERS.cost.objects, "two": 2}
    count = counts.get(step.objects, len(objects) or 1)
    return objects[:: max(1, -(-len(objects) // count))]


def inputs_of_step(study, step):
    """Return the inputs of a step by name, for `inputs`: lists of files, or two input functions (`features_for`)."""
    if "condition" in step.wildcards:
        return features_for(study.name)
    measured = measured_objects(study, step)
    available = {
        "meshes": meshes_of(measured),
        # The first block of viewpoints is enough.
        "fixations": places_of(
            files_of, objects=blocks_with(measured), views=[*VIEW_BLOCKS][:1]
        ),
        "features": run_features(study.name),
        "blocks": study_blocks(study.name),
        "recomputed_features": recomputed_features(
            study.name, PLANS[study.name].recomputations
        ),
        "predictions": (
            files_of("predictions", "{pipeline}/{strategy}")
            if takes_predictions(study)
            else []
        ),
    }
    where = step.inputs_where.items()
    available["tables"] = of_pipelines(
        [
            *(name for name in step.inputs if name not in available),
            *(file for name, file in where if attrgetter(name)(PARAMETERS)),
        ]
    )
    names = (*step.inputs, *(["tables"] if available["tables"] else []))
    return {name: available[name] for name in names if name in available}


def params_of_step(study, step):
    """Return the ``params`` of a step's rule, except ``key`` (`key_of_job`), by name for `study_step.py`."""
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
    if {"meshes", "fixations"} & {*step.inputs}:
        params["measured"] = measured_objects(study, step)
    if "recomputed_features" in step.inputs:
        params["recomputed"] = list(PLANS[study.name].recomputations)
    if "condition" in step.wildcards:
        params["recomputed"] = lambda wildcards: recomputed_keys(wildcards, study.name)
        params["condition"] = lambda wildcards: describe_conditions(
            conditions_of(wildcards, study.name)
        )[0]
    return params


def files_of_more_studies(wildcards):
    """List the files of studies that are not part of the run, for the report: files that are there or requested."""
    asked = asked_by_rule(ARGUMENTS, STUDIES.values())
    return [
        file
        for study in MORE_STUDIES
        for file in study.shown
        if study.name in asked or is_requested_or_there(file)
    ]


# Cached, so that the key and the job of the report have the same inputs: the key is computed before the sweep brings
# files back from the store, and the job's inputs are listed after it.
@cache
def is_requested_or_there(file):
    """Return whether the command names a file of a study or its record, or the file is in its place after the sweep."""
    if not DECIDES:
        return file in ARGUMENTS or Path(file).exists()
    makers = keys().makers([file])
    is_requested = not {file, *makers}.isdisjoint(ARGUMENTS)
    return is_requested or any(is_at_hand(keys(), record) for record in makers)


def studies_left_out(sweep):
    """Return sentences on the studies that a sweep moves out of the report, and that this run does not make again."""
    returned = {file for files in sweep.returned.values() for file in files}
    moved = {*sweep.moved} - returned
    made = [*ARGUMENTS, *(f"study_{study.name}" for study in STUDIES_OF_RUN)]
    return say_left_out(moved, STUDIES.values(), made, OPTIONS)


def report_of_study(wildcards):
    """List all files of the report as inputs of the target of a study; none in a stage of DVC."""
    return [] if "DVC_STAGE" in os.environ else rules.report_all.input
