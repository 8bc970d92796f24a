"""Stability: each object's mesh, probing locations and imprints → numerical errors and their tolerances.

Reads results/meshes/, results/fixations/, results/policy_fixations/ and results/touches/. Writes results/stability/. An
exceeded tolerance fails no job; the tables, the report and the last lines of the run name it.
"""


rule stability_all:
    input:
        files_of("stability", "{objects}"),
        files_of("records/stability", "{objects}", "json"),


rule stability_of_object:
    input:
        takes(
            "stability_of_object",
            meshes="results/meshes/{objects}",
            fixations=places_of(views_of),
            touches=views_of("touches"),
        ),
    output:
        "results/stability/{objects}.parquet",
        record="results/records/stability/{objects}.json",
    log:
        "logs/stability/{objects}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_job,
        attention=PARAMETERS.attention.model_dump(),
        sensor=PARAMETERS.sensor.model_dump(),
        scene=PARAMETERS.scene.model_dump(),
        seed=PARAMETERS.seed,
    message:
        "computing numerical errors of {wildcards.objects}"
    script:
        "../scripts/stability_of_object.py"
