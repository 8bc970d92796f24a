"""Recognition: features of all objects → scores and predictions for every split and classifier.

Takes results/features/; gives the tables results/scores/ and results/predictions/.
"""


rule recognition_all:
    input:
        scores_of("scores"),
        scores_of("predictions"),
        scores_of("records/recognition", "json"),


rule recognition:
    input:
        takes(
            "recognition",
            "recognition.py",
            check=check_recognition,
            features=parts_of("features"),
        ),
    output:
        scores="results/scores/{pipeline}/{strategy}.parquet",
        predictions="results/predictions/{pipeline}/{strategy}.parquet",
        record="results/records/recognition/{pipeline}/{strategy}.json",
    log:
        "logs/recognition/{pipeline}/{strategy}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        **phase_of("recognition").written_values(PARAMETERS),
        key=key_of_rule("recognition"),
    message:
        "training and testing on touches by {wildcards.strategy}, pipeline {wildcards.pipeline}"
    script:
        "../scripts/recognition.py"
