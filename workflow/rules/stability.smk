"""Stability: each object's mesh, probing locations and imprints → its numerical errors, beside their tolerances.

Takes results/meshes/, results/fixations/, results/policy_fixations/ and results/touches/; gives results/stability/. A tolerance that is
exceeded fails no job: the tables say so, the report shows it, and the run's last lines name it.
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
        "checking the numbers of {wildcards.objects} and others"
    script:
        "../scripts/stability_of_object.py"
