"""Features: tactile imprints and poses → 16 contourlet and 6 kinesthetic features a touch.

Takes results/touches/; gives the table results/features/.
"""


rule features_all:
    input:
        parts_of("features"),
        parts_of("records/features", "json"),


rule features:
    input:
        touches="results/touches/{object}/{views}.parquet",
        code=code_of("features.py"),
    output:
        "results/features/{object}/{views}.parquet",
        record="results/records/features/{object}/{views}.json",
    log:
        "logs/features/{object}/{views}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        features=PARAMETERS.features.model_dump(),
    message:
        "describing the imprints of {wildcards.object}, viewpoints {wildcards.views}"
    script:
        "../scripts/features.py"
