"""Studies: conditions that each change some parameters → how accuracy changes with them.

Takes results/meshes/, results/fixations/, results/touches/ and results/features/, and of a user's own studies
studies/<study>.yaml; gives results/study_features/<study>/ (what conditions share, made once),
results/study_blocks/<study>/ (some conditions a job), results/studies/<study>.parquet and reports/studies/<study>.json.
Studies `cost` and `curves` also give results/cost.parquet and results/touches_needed.parquet. Study `frontier`, which
gives results/frontier.parquet, and what effects cost, results/effect_influence.parquet, are part of `all`. The others
are not: `snakemake -j2 study_<study>` makes one (of those of the package also `cost_all`, `curves_all`,
`ablations_all`, `effects_all`, `readings_all`) and writes the report; later runs keep it up to date, or leave it as it is
(`workflow.keep_studies_current`).
"""

# The frontier and the readings have tables and sections of their own.
STUDY_FIGURES = {
    f"results/studies/{study}.parquet": study
    for study in STUDIES
    if study not in {"frontier", "readings"}
}
SPECIAL_FIGURES = {
    "results/readings.parquet": "readings",
    "reports/readings.json": "readings",
    "results/cost.parquet": "cost",
    "results/touches_needed.parquet": "curves",
    "results/certainty.parquet": "certainty",
    "reports/certainty.json": "certainty",
    "results/looking.parquet": "looking",
    "reports/looking.json": "looking",
}
TEMPLATES = in_clone(
    sorted(Path(shipped("src/visuohaptic/report/templates")).glob("*.*"))
)
# A few objects, spread over all, are enough to measure run times.
COST_SAMPLE = SAMPLE[:: max(1, -(-len(SAMPLE) // PARAMETERS.cost.objects))]
EFFECT_SAMPLE = OBJECTS[:: max(1, -(-len(OBJECTS) // 2))]
# Everything that a condition may depend on.
RUN = PARAMETERS.model_dump(
    exclude={
        "workflow": True,
        "meshes": True,
        "cost": True,
        "gaze": True,
        "recognition": {"intervals"},
    }
)
RUN_AND_INTERVALS = PARAMETERS.model_dump(
    exclude={"workflow", "meshes", "cost", "gaze"}
)


wildcard_constraints:
    weighed="frontier|cost",
    study="|".join(sorted(STUDIES)),
    key="[0-9a-f]+",
    reading="[a-z][0-9]+",
    block=r"\d+-\d+",


for study in set(STUDIES) - {"readings"}:

    rule:
        name:
            f"study_{study}"
        input:
            f"results/studies/{study}.parquet",
            f"reports/studies/{study}.json",
            # By name, so that a lost block is missed although its figures are there.
            study_blocks(study),
            report_of_study,


rule frontier_all:
    input:
        "results/frontier.parquet",
        # By name, so that a lost block is missed although its figures are there.
        study_blocks("frontier"),


rule influence_all:
    input:
        "results/effect_influence.parquet",


rule cost_all:
    input:
        "results/cost.parquet",
        rules.study_cost.input,


rule curves_all:
    input:
        "results/touches_needed.parquet",
        "reports/curves.json",
        rules.study_curves.input,


rule ablations_all:
    input:
        rules.study_ablations.input,


rule effects_all:
    input:
        "results/effect_influence.parquet",
        rules.study_effects.input,


rule study_readings:
    input:
        "results/readings.parquet",
        "reports/readings.json",
        "reports/readings.html",
        # By name, so that a lost block is missed although its figures are there.
        study_blocks("readings"),
        report_of_study,


rule readings_all:
    input:
        rules.study_readings.input,


rule features_of_study:
    input:
        takes(
            "features_of_study",
            "study_features.py",
            meshes=remade_from("meshes", {"views", "touches"}),
            fixations=remade_from("fixations", {"touches"}),
            touches=remade_from("touches", {"features"}),
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
        phase=remade_phase,
        sample=sample_of_study,
        parameters=remake_parameters,
    message:
        "making features again for study {wildcards.study}, from its {params.phase} on"
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
        remade=block_keys,
        parameters=RUN,
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


rule readings:
    input:
        takes(
            "readings",
            "readings.py",
            parts=study_blocks("readings"),
        ),
    output:
        readings="results/readings.parquet",
        metrics="reports/readings.json",
        record="results/records/readings.json",
    log:
        "logs/readings.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("readings"),
        intervals=PARAMETERS.recognition.intervals.model_dump(),
        seed=PARAMETERS.seed,
    message:
        "summing up the paper's readings"
    script:
        "../scripts/readings.py"


rule readings_page:
    input:
        takes(
            "readings_page",
            "readings_page.py",
            readings="results/readings.parquet",
            templates=TEMPLATES,
        ),
    output:
        "reports/readings.html",
        record="results/records/readings_page.json",
    log:
        "logs/readings_page.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("readings_page"),
    message:
        "writing the page of the paper's readings"
    script:
        "../scripts/readings_page.py"


# One dot of the page: `snakemake -j2 results/reading/r017.json`.
rule reading:
    input:
        takes(
            "reading",
            "reading.py",
            features=features_of_reading,
            made=made_of_reading,
        ),
    output:
        "results/reading/{reading}.json",
        record="results/records/reading/{reading}.json",
    log:
        "logs/reading/{reading}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("reading"),
        condition=condition_of_reading,
        remade=keys_of_reading,
        parameters=RUN_AND_INTERVALS,
    message:
        "measuring reading {wildcards.reading} of the paper"
    script:
        "../scripts/reading.py"


rule candidates_of_study:
    input:
        takes(
            "candidates_of_study",
            "study_candidates.py",
            meshes=meshes_of(),
        ),
    output:
        "results/study_candidates.parquet",
        record="results/records/candidates_of_study.json",
    log:
        "logs/study_candidates.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("candidates_of_study"),
        parameters=PARAMETERS.model_dump(
            exclude={"workflow", "meshes", "cost", "gaze", "recognition", "probing"}
        ),
    message:
        "touching objects wherever the strategy adaptive may choose to"
    script:
        "../scripts/study_candidates.py"


rule adaptive_of_study:
    input:
        takes(
            "adaptive_of_study",
            "study_adaptive.py",
            candidates="results/study_candidates.parquet",
        ),
    output:
        "results/study_adaptive/{pipeline}.parquet",
        record="results/records/adaptive_of_study/{pipeline}.json",
    log:
        "logs/study_adaptive/{pipeline}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("adaptive_of_study"),
        parameters=RUN,
    message:
        "naming objects after 1, 2 and more adaptive touches, pipeline {wildcards.pipeline}"
    script:
        "../scripts/study_adaptive.py"


rule touches_needed:
    input:
        takes(
            "touches_needed",
            "touches_needed.py",
            parts=study_blocks("curves"),
        ),
    output:
        needed="results/touches_needed.parquet",
        metrics="reports/curves.json",
        record="results/records/touches_needed.json",
    log:
        "logs/touches_needed.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("touches_needed"),
        intervals=PARAMETERS.recognition.intervals.model_dump(),
        seed=PARAMETERS.seed,
    message:
        "summing up the curves over touches"
    script:
        "../scripts/touches_needed.py"


rule cost_seconds:
    input:
        takes(
            "cost_seconds",
            "cost_seconds.py",
            meshes=meshes_of(COST_SAMPLE),
            features=parts_of("features", objects=SAMPLE),
            made=all_made_features,
        ),
    output:
        "results/{weighed}_seconds.parquet",
        record="results/records/{weighed}_seconds.json",
    log:
        "logs/{weighed}_seconds.log",
    conda:
        "../envs/visuohaptic.yaml"
    # It works on one; where it measures the whole study, it takes all there are, so that no other
    # job is in its way.
    threads: cores_for_timing
    params:
        key=key_of_rule("cost_seconds"),
        study=weighed_study,
        timed=COST_SAMPLE,
        sample=None if SAMPLE == OBJECTS else SAMPLE,
        remade=all_keys,
        parameters={
            **RUN,
            "cost": PARAMETERS.cost.model_dump(
                exclude={"touch_seconds", "look_seconds", "budgets", "adaptive"}
            ),
        },
    message:
        "timing all settings of study {wildcards.weighed} side by side"
    script:
        "../scripts/cost_seconds.py"


rule cost:
    input:
        takes(
            "cost",
            "cost.py",
            parts=weighed_blocks,
            seconds="results/{weighed}_seconds.parquet",
        ),
    output:
        "results/{weighed}.parquet",
        record="results/records/{weighed}.json",
    log:
        "logs/{weighed}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("cost"),
        study=weighed_study,
        parameters=PARAMETERS.model_dump(exclude={"workflow", "meshes", "gaze"}),
    message:
        "weighing accuracy against time, study {wildcards.weighed}"
    script:
        "../scripts/cost.py"


rule effect_influence:
    input:
        takes(
            "effect_influence",
            "effect_influence.py",
            meshes=meshes_of(EFFECT_SAMPLE),
            fixations=parts_of(
                "fixations", objects=EFFECT_SAMPLE, views=view_blocks()[:1]
            ),
        ),
    output:
        "results/effect_influence.parquet",
        record="results/records/effect_influence.json",
    log:
        "logs/effect_influence.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("effect_influence"),
        sample=EFFECT_SAMPLE,
        viewpoints=PARAMETERS.viewpoints.model_dump(),
        rendering=PARAMETERS.rendering.model_dump(),
        sensor=PARAMETERS.sensor.model_dump(),
        scene=PARAMETERS.scene.model_dump(),
        seed=PARAMETERS.seed,
        wanted=phase_of("touches").written_values(PARAMETERS)["wanted"],
    message:
        "measuring what each effect costs, and how far it moves images"
    script:
        "../scripts/effect_influence.py"
