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
        mesh="results/meshes/{object}.ply",
        fixations="results/fixations/{object}/{views}.parquet",
        code=code_of("touches.py"),
    output:
        touches="results/touches/{object}/{views}.parquet",
        effects="results/effects/touches/{object}/{views}.parquet",
        record="results/records/touches/{object}/{views}.json",
    log:
        "logs/touches/{object}/{views}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        sensor=PARAMETERS.sensor.model_dump(),
        scene=PARAMETERS.scene.model_dump(),
        seed=PARAMETERS.seed,
        wanted=WANTED,
    message:
        "touching {wildcards.object} from viewpoints {wildcards.views}"
    script:
        "../scripts/touches.py"
