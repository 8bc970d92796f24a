"""Recognition: features of all objects → scores and predictions for every split and classifier.

Takes results/features/; gives the tables results/scores/ and results/predictions/, a job per pipeline.
"""

# In the name of the record: a job of other strategies has another record, and files of a strategy that is no longer
# asked for are put aside.
STRATEGIES_ASKED = "+".join(PARAMETERS.probing.strategies)


rule recognition_all:
    input:
        files_of("scores", "{pipeline}/{strategy}"),
        files_of("predictions", "{pipeline}/{strategy}"),
        files_of("records/recognition", f"{{pipeline}}/{STRATEGIES_ASKED}", "json"),


rule recognition:
    input:
        takes("recognition", features=files_of("features")),
        # Stops before the first job where there are no classes to tell apart.
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
