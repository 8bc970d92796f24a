"""Recognition: features of all objects → scores and predictions for every split and classifier.

Reads results/features/. Writes the tables results/scores/ and results/predictions/, with one job per pipeline.
"""

from visuohaptic.recognition.parameters import unread_by

# Files of former strategies, which no output of today has.
FORMER_PATTERNS["recognition"] = [
    "results/scores/{pipeline}/{strategy}.parquet",
    "results/predictions/{pipeline}/{strategy}.parquet",
]


rule recognition_all:
    input:
        files_of("scores", "{pipeline}/{strategy}"),
        files_of("predictions", "{pipeline}/{strategy}"),
        files_of("records/recognition", "{pipeline}", "json"),


rule recognition:
    input:
        takes("recognition", features=files_of("features")),
        # Stops before the first job if there are fewer than two classes.
        checked=lambda wildcards: or_stop(check_classes, OBJECTS) or [],
    output:
        scores=files_of("scores", "{{pipeline}}/{strategy}"),
        predictions=files_of("predictions", "{{pipeline}}/{strategy}"),
        record="results/records/recognition/{pipeline}.json",
    log:
        "logs/recognition/{pipeline}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        recognition=lambda wildcards: PARAMETERS.recognition.model_dump(
            exclude={"pipelines", "intervals", *unread_by(wildcards.pipeline)}
        ),
        seed=PARAMETERS.seed,
        key=key_of_job,
        strategies=PARAMETERS.probing.strategies,
    message:
        "training and testing pipeline {wildcards.pipeline}"
    script:
        "../scripts/recognition.py"
