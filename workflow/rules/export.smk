"""Export: touches of all objects → a data set for Hugging Face `datasets` and other tools.

Takes results/touches/, features, predictions, metrics and the credits; gives results/export/: Parquet files, a lite version, the
experiment's features and results, card, credits and croissant.json. Not part of `all`.
"""

EXPORTED = [
    "README.md",
    "credits.csv",
    "croissant.json",
    "experiment.json",
    "sample.png",
    *expand(
        "{folder}/{split}.parquet", folder=["data", "lite"], split=["train", "test"]
    ),
    "features/run.parquet",
]


rule export:
    input:
        takes(
            "export",
            touches=files_of("touches"),
            features=files_of("features"),
            predictions=files_of("predictions", "{pipeline}/{strategy}"),
            metrics="reports/metrics.json",
            credits=CREDITS,
        ),
    output:
        expand("results/export/{file}", file=EXPORTED),
        record="results/records/export.json",
    log:
        "logs/export.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_job,
        seed=PARAMETERS.seed,
        commit=lambda wildcards: find_commit(),
        parameters=PARAMETERS.model_dump(mode="json", exclude={"workflow"}),
    message:
        "exporting touches as a data set"
    script:
        "../scripts/export.py"


rule export_all:
    input:
        rules.export.output,
