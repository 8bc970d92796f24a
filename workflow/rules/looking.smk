"""Looking: prepared meshes → what the eye alone recognises, what touch adds, and when the next touch pays.

Takes results/meshes/ and results/study_candidates.parquet, which study `curves` also takes; gives
results/looking.parquet and reports/looking.json. Not part of `all`: `snakemake -j2 looking_all` makes it and
writes the report.
"""


rule study_looking:
    input:
        "results/looking.parquet",
        "reports/looking.json",
        "results/records/looking.json",
        report_of_study,


rule looking_all:
    input:
        rules.study_looking.input,


rule looking:
    input:
        takes(
            "looking",
            "looking.py",
            meshes=meshes_of(),
            candidates=(
                "results/study_candidates.parquet" if PARAMETERS.cost.adaptive else []
            ),
        ),
    output:
        table="results/looking.parquet",
        metrics="reports/looking.json",
        record="results/records/looking.json",
    log:
        "logs/looking.log",
    conda:
        "../envs/visuohaptic.yaml"
    threads: all_cores
    params:
        key=key_of_rule("looking"),
        parameters={
            **RUN_AND_INTERVALS,
            "cost": PARAMETERS.cost.model_dump(
                include={"touch_seconds", "look_seconds", "budgets", "adaptive"}
            ),
        },
    message:
        "recognising objects by eye, by touch and by both, in good sight and in poor"
    script:
        "../scripts/looking.py"
