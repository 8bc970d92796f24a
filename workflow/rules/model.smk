"""Model: features of all objects → the recognition model that `visuohaptic recognise` loads.

Reads results/features/. Writes results/models/recogniser.skops, which contains the parameters of its touches, but no
code. This model is trained on touches of the first strategy. Models of other strategies are targets by name, such as
results/models/recogniser_random.skops; results/models/all_strategies.skops is trained on all touches of the run. Study
`trust` measures how reliable the answers of such models are.
"""

MODELS = {
    "recogniser": PARAMETERS.probing.strategies[:1],
    **{
        f"recogniser_{strategy}": (strategy,)
        for strategy in PARAMETERS.probing.strategies[1:]
    },
    "all_strategies": PARAMETERS.probing.strategies,
}
VALUES_OF_RULES["model"] = [{"model": name} for name in MODELS]


CONSTRAINTS |= {"model": "|".join(MODELS)}


wildcard_constraints:
    **CONSTRAINTS,


rule model_all:
    input:
        "results/models/recogniser.skops",
        "results/model_records/recogniser.json",


rule model:
    input:
        takes("model", features=files_of("features")),
    output:
        model="results/models/{model}.skops",
        record="results/model_records/{model}.json",
    log:
        "logs/model/{model}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_job,
        pipeline="order_free",
        classifier="linear_discriminant",
        strategies=lambda wildcards: list(MODELS[wildcards.model]),
        recognition=PARAMETERS.recognition.model_dump(
            exclude={"pipelines", "protocol", "intervals"}
        ),
        touching=PARAMETERS.model_dump(
            mode="json", exclude={"workflow", "recognition", "cost"}
        ),
        seed=PARAMETERS.seed,
    message:
        "fitting recognition model {wildcards.model} on all objects"
    script:
        "../scripts/model.py"
