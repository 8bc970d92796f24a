"""Export: touches of all objects → a data set for Hugging Face `datasets` and other tools.

Takes results/touches/ and the credits; gives results/export/: Parquet files, a lite version, card, credits and
croissant.json. Not part of `all`.
"""

EXPORTED = [
    "README.md",
    "credits.csv",
    "croissant.json",
    *expand(
        "{folder}/{split}.parquet", folder=["data", "lite"], split=["train", "test"]
    ),
]


rule export_all:
    input:
        expand("results/export/{file}", file=EXPORTED),
        "results/records/export.json",


rule export:
    input:
        takes(
            "export",
            "export.py",
            touches=parts_of("touches"),
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
        key=key_of_rule("export"),
        seed=PARAMETERS.seed,
    message:
        "exporting touches as a data set"
    script:
        "../scripts/export.py"
