"""Touches: probing locations → tactile imprints, the sensor's pose and size, the contact's state.

Takes results/meshes/ and results/fixations/; gives the tables results/touches/ and
results/effects/touches/ (effect log: why each effect of the sensor was needed, and its run time).
"""


rule touches_all:
    input:
        parts_of("touches"),
        parts_of("effects/touches"),
        parts_of("records/touches", "json"),


rule touches:
    input:
        meshes="results/meshes/{objects}",
        fixations="results/fixations/{objects}/{views}.parquet",
        code=code_of("touches.py"),
    output:
        touches="results/touches/{objects}/{views}.parquet",
        effects="results/effects/touches/{objects}/{views}.parquet",
        record="results/records/touches/{objects}/{views}.json",
    log:
        "logs/touches/{objects}/{views}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        sensor=PARAMETERS.sensor.model_dump(),
        scene=PARAMETERS.scene.model_dump(),
        seed=PARAMETERS.seed,
        wanted=WANTED,
    message:
        "touching {wildcards.objects} and others from viewpoints {wildcards.views}"
    script:
        "../scripts/touches.py"
