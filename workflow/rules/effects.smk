"""Effects: what each costs where it is not called for, and how far it moves images and accuracy.

Takes results/meshes/ and results/fixations/; gives results/effect_influence.parquet and
results/effect_accuracy.parquet. A run makes neither, for the accuracy is measured in some twenty scenes:
`snakemake -j2 effects_all` does, and from then on the report shows them and every run keeps them
current, until they are deleted.
"""

EFFECT_FIGURES = ["results/effect_influence.parquet", "results/effect_accuracy.parquet"]

# So few objects, spread over all, tell what effects cost and move.
SAMPLE = OBJECTS[:: max(1, -(-len(OBJECTS) // 4))]


rule effects_all:
    input:
        EFFECT_FIGURES,


rule effect_influence:
    input:
        meshes=expand("results/meshes/{object}.ply", object=SAMPLE),
        fixations=expand(
            "results/fixations/{object}/{views}.parquet",
            object=SAMPLE,
            views=view_blocks()[0],
        ),
        code=code_of("effect_influence.py"),
    output:
        "results/effect_influence.parquet",
        record="results/records/effect_influence.json",
    log:
        "logs/effect_influence.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        viewpoints=PARAMETERS.viewpoints.model_dump(),
        rendering=PARAMETERS.rendering.model_dump(),
        sensor=PARAMETERS.sensor.model_dump(),
        scene=PARAMETERS.scene.model_dump(),
        seed=PARAMETERS.seed,
    message:
        "measuring what each effect costs, and how far it moves images"
    script:
        "../scripts/effect_influence.py"


rule effect_accuracy:
    input:
        meshes=expand("results/meshes/{object}.ply", object=OBJECTS),
        fixations=parts_of("fixations"),
        code=code_of("effect_accuracy.py"),
    output:
        "results/effect_accuracy.parquet",
        record="results/records/effect_accuracy.json",
    log:
        "logs/effect_accuracy.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        sensor=PARAMETERS.sensor.model_dump(),
        features=PARAMETERS.features.model_dump(),
        recognition=PARAMETERS.recognition.model_dump(exclude={"pipelines"}),
        seed=PARAMETERS.seed,
    message:
        "measuring how far each effect moves the accuracy"
    script:
        "../scripts/effect_accuracy.py"
