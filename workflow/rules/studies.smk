"""Studies: conditions that each change some parameters → how accuracy changes with them.

Takes results/meshes/, results/fixations/, results/touches/ and results/features/, and of a user's own studies
studies/<study>.yaml or .py; gives results/study_features/<study>/ (what conditions share, made once),
results/study_blocks/<study>/ (some conditions a job), results/studies/<study>.parquet and reports/studies/<study>.json,
and what a study's own steps make (`visuohaptic.studies.study.Step`). Studies `frontier` and `influence` are part of
`all`. The others are not: `snakemake -j2 study_<study>` makes one, as `<study>_all` does for those of Python, and writes
the report; later runs keep it up to date, or leave it as it is (`workflow.keep_studies_current`). Of studies that a run
is not asked for and that have no files there are no rules.
"""


wildcard_constraints:
    study="|".join(sorted(STUDIES)),
    key="[0-9a-f]+",
    block=r"\d+-\d+",


# Studies of the package and of Python have a second name; those that are part of every run have it without the report.
for name, study, report_of_name in [
    *((f"study_{one.name}", one, report_of_study) for one in STUDIES.values()),
    *(
        (f"{one.name}_all", one, [] if one.is_part_of_run else report_of_study)
        for one in STUDIES.values()
        if one.is_coded
    ),
]:

    rule:
        name:
            name
        input:
            study.targets,
            # By name, so that a lost block is missed although its figures are there.
            study_blocks(study.name),
            report_of_name,


rule features_of_study:
    input:
        takes(
            "features_of_study",
            **{name: needed_by_recomputation(name) for name in NEEDED},
        ),
    output:
        "results/study_features/{study}/{key}.parquet",
        record="results/study_records/features_of_study/{study}/{key}.json",
    log:
        "logs/study_features/{study}/{key}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_job,
        phase=lambda wildcards: recomputation_of(wildcards).phase,
        sample=lambda wildcards: sample_of(wildcards.study),
        parameters=recomputation_parameters,
    message:
        "recomputing features for study {wildcards.study}, from its {params.phase} on"
    script:
        "../scripts/features_of_study.py"


rule block_of_study:
    input:
        takes("block_of_study", **features_for()),
    output:
        "results/study_blocks/{study}/{block}.parquet",
        record="results/study_records/block_of_study/{study}/{block}.json",
    log:
        "logs/study_block/{study}/{block}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_job,
        conditions=lambda wildcards: describe_conditions(conditions_of(wildcards)),
        sample=lambda wildcards: sample_of(wildcards.study),
        recomputed=keys_of,
        parameters=PARAMETERS.model_dump(**DUMP_FOR_CONDITIONS),
    message:
        "measuring conditions {wildcards.block} of study {wildcards.study}"
    script:
        "../scripts/block_of_study.py"


rule figures_of_study:
    input:
        takes(
            "figures_of_study",
            parts=lambda wildcards: study_blocks(wildcards.study),
        ),
    output:
        figures="results/studies/{study}.parquet",
        metrics="reports/studies/{study}.json",
        record="results/study_records/figures_of_study/{study}.json",
    log:
        "logs/study_figures/{study}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_job,
        study=lambda wildcards: describe_study(
            STUDIES[wildcards.study], PLANS[wildcards.study]
        ),
        intervals=PARAMETERS.recognition.intervals.model_dump(),
    message:
        "summing up study {wildcards.study}"
    script:
        "../scripts/figures_of_study.py"


for study, step in STEPS:

    rule:
        name:
            step.name
        input:
            takes(
                step.name,
                "study_step.py",
                own=own_code_of(step),
                **inputs_of_step(study, step),
            ),
        output:
            *step.files,
            record=step.record,
        log:
            step.record.replace("results/study_records", "logs").replace(
                ".json", ".log"
            ),
        conda:
            "../envs/visuohaptic.yaml"
        # What measures run times works on one, and takes all there are, so that no other job is in its way.
        threads: all_cores if step.is_alone else 1
        params:
            **params_of_step(study, step),
            key=key_of_job,
        message:
            f"study {study.name}: {step.name.replace('_', ' ')}"
        script:
            "../scripts/study_step.py"
