"""Model: features of all objects → the recognition model that `visuohaptic recognise` loads.

Takes results/features/; gives results/models/best.skops, which holds no code, and
results/models/best.yaml, the parameters with which its touches were made. `certainty_all` measures how far the answers
of such models can be relied on: results/certainty.parquet and reports/certainty.json.
"""


rule model_all:
    input:
        "results/models/best.skops",
        "results/models/best.yaml",
        "results/records/model.json",


rule study_certainty:
    input:
        "results/certainty.parquet",
        "reports/certainty.json",
        "results/records/certainty.json",
        report_of_study,


rule certainty_all:
    input:
        rules.study_certainty.input,


rule certainty:
    input:
        takes(
            "certainty",
            "certainty.py",
            features=parts_of("features"),
        ),
    output:
        table="results/certainty.parquet",
        metrics="reports/certainty.json",
        record="results/records/certainty.json",
    log:
        "logs/certainty.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("certainty"),
        classifier="support_vector_machine",
        strategies=PARAMETERS.probing.strategies,
        recognition=PARAMETERS.recognition.model_dump(exclude={"pipelines"}),
        seed=PARAMETERS.seed,
    message:
        "naming known and unknown objects by models that lack a class"
    script:
        "../scripts/certainty.py"


rule model:
    input:
        takes(
            "model",
            "model.py",
            features=parts_of("features"),
        ),
    output:
        model="results/models/best.skops",
        touching="results/models/best.yaml",
        record="results/records/model.json",
    log:
        "logs/model.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("model"),
        pipeline="best",
        classifier="support_vector_machine",
        strategy=PARAMETERS.probing.strategies[0],
        recognition=PARAMETERS.recognition.model_dump(
            exclude={"pipelines", "protocol", "intervals"}
        ),
        touching=PARAMETERS.model_dump(
            mode="json", exclude={"workflow", "recognition", "cost", "gaze"}
        ),
        seed=PARAMETERS.seed,
    message:
        "fitting the recognition model on all objects"
    script:
        "../scripts/model.py"
