"""Stability: each object's mesh, probing locations and imprints → its numerical errors, beside their tolerances.

Takes results/meshes/, results/fixations/ and results/touches/; gives results/stability/. A tolerance that is
exceeded fails no job: the tables say so, the report shows it, and the run's last lines name it.
"""


rule stability_all:
    input:
        files_by_object("stability"),
        files_by_object("records/stability", "json"),


rule stability_of_object:
    input:
        mesh="results/meshes/{object}.ply",
        fixations=blocks_of("fixations"),
        touches=blocks_of("touches"),
        code=code_of("stability_object.py"),
    output:
        "results/stability/{object}.parquet",
        record="results/records/stability/{object}.json",
    log:
        "logs/stability/{object}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        attention=PARAMETERS.attention.model_dump(),
        sensor=PARAMETERS.sensor.model_dump(),
        scene=PARAMETERS.scene.model_dump(),
        seed=PARAMETERS.seed,
    message:
        "checking the numbers of {wildcards.object}"
    script:
        "../scripts/stability_object.py"
