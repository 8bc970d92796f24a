"""Features: tactile imprints and poses → 16 contourlet and 6 kinesthetic features a touch.

Takes results/touches/; gives the table results/features/.
"""


rule features_all:
    input:
        parts_of("features"),
        parts_of("records/features", "json"),


rule features:
    input:
        touches="results/touches/{objects}/{views}.parquet",
        code=code_of("features.py"),
    output:
        "results/features/{objects}/{views}.parquet",
        record="results/records/features/{objects}/{views}.json",
    log:
        "logs/features/{objects}/{views}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        features=PARAMETERS.features.model_dump(),
    message:
        "describing the imprints of {wildcards.objects} and others, viewpoints {wildcards.views}"
    script:
        "../scripts/features.py"
