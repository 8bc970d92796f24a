"""Model: features of all objects → the recognition model that `visuohaptic recognise` loads.

Takes results/features/; gives results/models/recogniser.skops, which holds no code, but the parameters with
which its touches were made. A model of other touches than those of the first strategy is made by its name, such as
results/models/recogniser_random.skops; results/models/all_strategies.skops learns from all touches of the run. Study `trust` measures how far the answers of such models can be relied on.
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


wildcard_constraints:
    model="|".join(MODELS),


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
