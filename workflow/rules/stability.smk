"""Stability: hard cases with known answers → the worst error of each kind, beside its tolerance.

Takes no file for results/stability.parquet: code and random seed decide what it holds. Of each object it takes
results/meshes/, results/fixations/ and results/touches/, and gives results/stability/. A tolerance that is exceeded
fails no job: the tables say so, the report shows it, and the run's last lines name it.
"""


rule stability_all:
    input:
        "results/stability.parquet",
        "results/records/stability.json",
        files_by_block("stability"),
        files_by_block("records/stability", "json"),


rule stability:
    input:
        code=code_of("stability.py"),
    output:
        "results/stability.parquet",
        record="results/records/stability.json",
    log:
        "logs/stability.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        seed=PARAMETERS.seed,
    message:
        "trying hard cases with known answers"
    script:
        "../scripts/stability.py"


rule stability_of_object:
    input:
        meshes="results/meshes/{objects}",
        fixations=views_of("fixations"),
        touches=views_of("touches"),
        code=code_of("stability_object.py"),
    output:
        "results/stability/{objects}.parquet",
        record="results/records/stability/{objects}.json",
    log:
        "logs/stability/{objects}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        attention=PARAMETERS.attention.model_dump(),
        sensor=PARAMETERS.sensor.model_dump(),
        scene=PARAMETERS.scene.model_dump(),
        seed=PARAMETERS.seed,
    message:
        "checking the numbers of {wildcards.objects} and others"
    script:
        "../scripts/stability_object.py"
