"""Studies: conditions that change parameters → the accuracy of each condition.

Reads results/meshes/, results/fixations/, results/touches/ and results/features/, and the user's studies
studies/<study>.yaml or .py. Writes results/study_features/<study>/ (features that conditions share),
results/study_blocks/<study>/ (one file per block of conditions), results/studies/<study>.parquet,
reports/studies/<study>.json, and the files of a study's steps (`visuohaptic.studies.study.Step`).

Studies of the package are part of `all`, except study `effects`; `workflow.studies` adds studies to `all`.
`snakemake -j2 study_<study>` makes any study and the report; for studies in Python, so does `<study>_all`. Studies have
rules only if they are requested, have files, or are part of the run.
"""

CONSTRAINTS |= {
    "study": "|".join(sorted(STUDIES)),
    "key": "[0-9a-f]+",
    "block": r"\d+-\d+",
}


wildcard_constraints:
    **CONSTRAINTS,


# Target study_<study> for each study, with the report. Also <study>_all for each study of the package or in Python, with
# the report unless the study is part of every run.
for name, study, report_of_name in [
    *((f"study_{study.name}", study, report_of_study) for study in STUDIES.values()),
    *(
        (f"{study.name}_all", study, [] if study in STUDIES_OF_RUN else report_of_study)
        for study in STUDIES.values()
        if study.is_coded
    ),
]:

    rule:
        name:
            name
        input:
            files_of_study(study.name),
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
        "recomputing features for study {wildcards.study}, from {params.phase} on"
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
        recomputed=recomputed_keys,
        seed=PARAMETERS.seed,
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
        "summarising study {wildcards.study}"
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
                own=user_code_of(step),
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
        # Jobs that measure run times reserve all cores, so that no other job runs at the same time.
        threads: all_cores if step.is_alone else 1
        params:
            **params_of_step(study, step),
            key=key_of_job,
        message:
            f"study {study.name}: {step.name.replace('_', ' ')}"
        script:
            "../scripts/study_step.py"
