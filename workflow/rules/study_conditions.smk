"""What the rules of studies share: conditions, their blocks, and what each job takes."""

from visuohaptic.studies.conditions import (
    describe_conditions,
    describe_study,
    plan_study,
)
from visuohaptic.studies.declared import declared_studies, make_blocks
from visuohaptic.studies.sampling import sample_objects
from visuohaptic_workflow.studies_asked import (
    belongs_to,
    names_rule,
    studies_asked_for,
)

STUDIES = or_stop(
    declared_studies,
    PARAMETERS,
    [
        file
        for file in Path(shipped("studies")).glob("*.yaml")
        if file.name != "dvc.yaml"
    ],
)
PLANS = {
    name: or_stop(plan_study, study, PARAMETERS) for name, study in STUDIES.items()
}
BLOCKS = {
    name: make_blocks(plan, PARAMETERS.workflow.conditions_per_job)
    for name, plan in PLANS.items()
}
# With thousands of objects these would take longer than all the rest.
SAMPLED_STUDIES = {"frontier", "cost"}
SAMPLE = sample_objects(OBJECTS, PARAMETERS.cost.maximum_objects)


def figures_of(study):
    """Name the table that sums up a study."""
    if study in {"readings", "certainty", "looking"}:
        return f"results/{study}.parquet"
    return f"results/studies/{study}.parquet"


# What the report shows beside the run itself; certainty and looking have no conditions.
SHOWN_STUDIES = [*STUDIES, "certainty", "looking"]
if IS_PLANNER:
    os.environ.update(VISUOHAPTIC_ARGUMENTS=json.dumps(sys.argv[1:]))
ARGUMENTS = json.loads(os.environ.setdefault("VISUOHAPTIC_ARGUMENTS", "[]"))
ASKED_STUDIES = studies_asked_for(ARGUMENTS, SHOWN_STUDIES)
# Measured once, and left as they are.
KEPT_STUDIES = {
    name
    for name in SHOWN_STUDIES
    if IS_KEYED and IS_PLANNER and name != "frontier"
    # The readings take half an hour, so only their own target brings them up to date.
    and (name == "readings" or not PARAMETERS.workflow.keep_studies_current)
    and name not in ASKED_STUDIES
    and Path(figures_of(name)).exists()
}

VALUES_OF_RULES["features_of_study"] = [
    {"study": name, "key": key} for name, plan in PLANS.items() for key in plan.remakes
]
VALUES_OF_RULES["block_of_study"] = [
    {"study": name, "block": block}
    for name, blocks in BLOCKS.items()
    for block in blocks
]
VALUES_OF_RULES["cost_seconds"] = VALUES_OF_RULES["cost"] = [
    {"weighed": "frontier"},
    {"weighed": "cost"},
]
VALUES_OF_RULES["figures_of_study"] = [
    {"study": name} for name in STUDIES if name != "readings"
]
READINGS = {one.condition.name: one for one in PLANS["readings"].conditions}
VALUES_OF_RULES["reading"] = [{"reading": name} for name in READINGS]


def study_blocks(study):
    """List the files of a study's blocks, and of what is measured beside them."""
    blocks = [
        f"results/study_blocks/{study}/{block}.parquet" for block in BLOCKS[study]
    ]
    adaptive = expand(
        "results/study_adaptive/{pipeline}.parquet",
        pipeline=PARAMETERS.recognition.pipelines,
    )
    return [*blocks, *adaptive] if study == "curves" else blocks


def remade_from(table, phases):
    """Give what lists the parts of a table for features that are made again from these phases on."""

    def files(wildcards):
        if remade_phase(wildcards) not in phases:
            return []
        objects = objects_of_study(wildcards.study)
        if table == "meshes":
            return meshes_of(objects)
        return parts_of(table, objects=objects)

    return files


def objects_of_study(study):
    """List the objects that a study measures."""
    return SAMPLE if study in SAMPLED_STUDIES else OBJECTS


def sample_of_study(wildcards):
    """List the objects that a study takes of blocks that may hold more; nothing where it takes all."""
    objects = objects_of_study(wildcards.study)
    return None if objects == OBJECTS else objects


def remake_of(wildcards):
    """Give the features that a job makes again."""
    return PLANS[wildcards.study].remakes[wildcards.key]


def remade_phase(wildcards):
    """Name the first phase that a job makes again."""
    return remake_of(wildcards).phase


def remake_parameters(wildcards):
    """Give the parameters that a job makes features again with."""
    return remake_of(wildcards).parameters.model_dump(
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


def keys_of_reading(wildcards):
    """Name the features of a reading, unless they are the run's."""
    key = READINGS[wildcards.reading].key
    return [] if key is None else [key]


def made_of_reading(wildcards):
    """List the file of a reading's features, unless they are the run's."""
    return made_features("readings", keys_of_reading(wildcards))


def features_of_reading(wildcards):
    """List the run's own features for a reading that has no others."""
    return [] if keys_of_reading(wildcards) else parts_of("features")


def condition_of_reading(wildcards):
    """Give the condition of a reading."""
    return describe_conditions([READINGS[wildcards.reading]])[0]


def weighed_study(wildcards):
    """Name the study that a job weighs."""
    return wildcards.weighed


def all_keys(wildcards):
    """Name the features of a weighed study that the run does not have."""
    return list(PLANS[wildcards.weighed].remakes)


def all_made_features(wildcards):
    """List their files."""
    return made_features(wildcards.weighed, all_keys(wildcards))


def weighed_blocks(wildcards):
    """List the files of a weighed study's blocks."""
    return study_blocks(wildcards.weighed)


def cores_for_timing(wildcards):
    """Give one core to the frontier, which is small and part of every run, and all to a whole study."""
    return 1 if wildcards.weighed == "frontier" else all_cores(wildcards)


def is_shown(file, study):
    """Whether the report shows a file of a study: one that exists, or that this run makes."""
    is_made = study in ASKED_STUDIES and (
        file.startswith("results/studies/")
        or study in {"readings", "certainty", "looking"}
        or names_rule(ARGUMENTS, f"{study}_all")
    )
    return is_made or Path(file).exists()


def shown_studies(wildcards):
    """Say by which keys the report knows that a study is of today's state."""
    figures = {**STUDY_FIGURES, **SPECIAL_FIGURES} if IS_KEYED else {}
    shown = {}
    for file, study in figures.items():
        if is_shown(file, study):
            found = shown.setdefault(study, {"figures": figures_of(study), "keys": {}})
            found["keys"] |= {
                record: keys().key(record) for record in keys().makers([file])
            }
    return shown


def keep_studies():
    """Name the records of studies that are left as they are."""
    KEPT_RECORDS.update(
        job.record
        for job in (planned_jobs() if KEPT_STUDIES else [])
        if any(belongs_to(job, study) for study in KEPT_STUDIES)
    )


def report_of_study(wildcards):
    """List the report, which shows a study; in DVC it has a stage of its own."""
    return [] if "DVC_STAGE" in os.environ else rules.report_all.input
