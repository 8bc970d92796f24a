"""Recognition: features of all objects → scores and predictions for every split and classifier.

Reads results/features/. Writes the tables results/scores/ and results/predictions/, with one job per pipeline.
"""

# Part of the record's name: with other strategies the job has another record, and files of former strategies are moved
# aside.
STRATEGIES_ASKED = "+".join(PARAMETERS.probing.strategies)
FORMER_PATTERNS["recognition"] = [
    "results/scores/{pipeline}/{strategy}.parquet",
    "results/predictions/{pipeline}/{strategy}.parquet",
    "results/records/recognition/{pipeline}/{strategies}.json",
]


rule recognition_all:
    input:
        files_of("scores", "{pipeline}/{strategy}"),
        files_of("predictions", "{pipeline}/{strategy}"),
        files_of("records/recognition", f"{{pipeline}}/{STRATEGIES_ASKED}", "json"),


rule recognition:
    input:
        takes("recognition", features=files_of("features")),
        # Stops before the first job if there are fewer than two classes.
        checked=lambda wildcards: or_stop(check_classes, OBJECTS) or [],
    output:
        scores=files_of("scores", "{{pipeline}}/{strategy}"),
        predictions=files_of("predictions", "{{pipeline}}/{strategy}"),
        record=f"results/records/recognition/{{pipeline}}/{STRATEGIES_ASKED}.json",
    log:
        f"logs/recognition/{{pipeline}}/{STRATEGIES_ASKED}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        **phase_of("recognition").written_values(PARAMETERS),
        key=key_of_job,
        strategies=PARAMETERS.probing.strategies,
    message:
        "training and testing pipeline {wildcards.pipeline}"
    script:
        "../scripts/recognition.py"
