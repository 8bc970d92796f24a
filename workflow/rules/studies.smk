"""Studies: conditions that each change some parameters → how accuracy changes with them.

Takes results/meshes/, results/fixations/, results/touches/ and results/features/, and of a user's own studies
studies/<study>.yaml or .py; gives results/study_features/<study>/ (what conditions share, made once),
results/study_blocks/<study>/ (some conditions a job), results/studies/<study>.parquet and reports/studies/<study>.json,
and what a study's own steps make (`visuohaptic.studies.study.Step`). Studies `frontier` and `influence` are part of
`all`. The others are not: `snakemake -j2 study_<study>` makes one, as `<study>_all` does for those of Python, and writes
the report; later runs keep it up to date, or leave it as it is (`workflow.keep_studies_current`).
"""


wildcard_constraints:
    study="|".join(sorted(STUDIES)),
    key="[0-9a-f]+",
    block=r"\d+-\d+",


for study in STUDIES.values():

    rule:
        name:
            f"study_{study.name}"
        input:
            study.targets,
            # By name, so that a lost block is missed although its figures are there.
            study_blocks(study.name),
            report_of_study,


# Those of the package and of Python; those that are part of every run, without the report.
for study in STUDIES.values():
    if study.is_coded:

        rule:
            name:
                f"{study.name}_all"
            input:
                study.targets,
                study_blocks(study.name),
                [] if study.is_part_of_run else report_of_study,


rule features_of_study:
    input:
        takes(
            "features_of_study",
            "study_features.py",
            meshes=recomputed_from("meshes", {"views", "touches"}),
            fixations=recomputed_from("fixations", {"touches"}),
            touches=recomputed_from("touches", {"features"}),
        ),
    output:
        "results/study_features/{study}/{key}.parquet",
        record="results/records/features_of_study/{study}/{key}.json",
    log:
        "logs/study_features/{study}/{key}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("features_of_study"),
        phase=recomputed_phase,
        sample=sample_of_study,
        parameters=recomputation_parameters,
    message:
        "recomputing features for study {wildcards.study}, from its {params.phase} on"
    script:
        "../scripts/study_features.py"


rule block_of_study:
    input:
        takes(
            "block_of_study",
            "study_block.py",
            features=own_features,
            made=block_features,
        ),
    output:
        "results/study_blocks/{study}/{block}.parquet",
        record="results/records/block_of_study/{study}/{block}.json",
    log:
        "logs/study_block/{study}/{block}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("block_of_study"),
        conditions=block_conditions,
        sample=sample_of_study,
        recomputed=block_keys,
        parameters=PARAMETERS.model_dump(**OF_CONDITIONS),
    message:
        "measuring conditions {wildcards.block} of study {wildcards.study}"
    script:
        "../scripts/study_block.py"


rule figures_of_study:
    input:
        takes(
            "figures_of_study",
            "study_figures.py",
            parts=study_parts,
        ),
    output:
        figures="results/studies/{study}.parquet",
        metrics="reports/studies/{study}.json",
        record="results/records/figures_of_study/{study}.json",
    log:
        "logs/study_figures/{study}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("figures_of_study"),
        study=described_study,
        intervals=PARAMETERS.recognition.intervals.model_dump(),
        seed=PARAMETERS.seed,
    message:
        "summing up study {wildcards.study}"
    script:
        "../scripts/study_figures.py"


for study, step in STEPS:

    rule:
        name:
            step.name
        input:
            takes(
                step.name,
                code_of_step(step),
                **inputs_of_step(study, step),
                sources=sources_of_step(step),
            ),
        output:
            *step.files,
            record=step.record,
        log:
            step.record.replace("results/records", "logs").replace(".json", ".log"),
        conda:
            "../envs/visuohaptic.yaml"
        # What measures run times works on one, and takes all there are, so that no other job is in its way.
        threads: all_cores if step.is_alone else 1
        params:
            key=key_of_rule(step.name),
            study=study.name,
            work=step.work,
            inputs=list(inputs_of_step(study, step)),
            files=len(step.files),
            parameters=PARAMETERS.model_dump(**step.needs),
            measured=(
                measured_objects(study, step)
                if {"meshes", "fixations"} & {*step.takes}
                else None
            ),
            sample=sample_of(study.name),
            recomputed=recomputed_for(study, step),
            condition=described_condition(study, step),
        message:
            f"study {study.name}: {step.name.replace('_', ' ')}"
        script:
            "../scripts/study_step.py"
