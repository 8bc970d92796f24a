"""Meshes: source models → one clean, centred, coloured surface of unit size per object.

Reads meshes/catalogue.csv, meshes/paper/ and meshes/own/, and downloads missing models of the set. Writes
results/meshes/<block>/<class>/<object>.ply; `visuohaptic_workflow.blocks` names blocks.
"""

from dataclasses import asdict

CREDITS = in_clone(map(shipped, ["meshes/catalogue.csv", "meshes/paper/credits.csv"]))


rule meshes_all:
    input:
        meshes_of(),
        files_of("records/meshes", "{objects}", "json"),
        ["meshes/downloaded/credits.csv"] if DOWNLOADED else [],


rule downloads:
    input:
        takes("downloads"),
    output:
        models=expand("meshes/downloaded/{object}.ply.gz", object=sorted(DOWNLOADED)),
        record="results/records/downloads.json",
    log:
        "logs/downloads.log",
    conda:
        "../envs/visuohaptic.yaml"
    threads: 2
    params:
        key=key_of_job,
        models=[
            {name: value for name, value in asdict(model).items() if name != "credit"}
            for _, model in sorted(DOWNLOADED.items())
        ],
        cache=".cache/models",
    message:
        "downloading the models that the set needs"
    script:
        "../scripts/downloads.py"


rule credits:
    input:
        takes("credits"),
    output:
        credits="meshes/downloaded/credits.csv",
        record="results/records/credits.json",
    log:
        "logs/credits.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_job,
        models=[asdict(model) for _, model in sorted(DOWNLOADED.items())],
    message:
        "writing the credits of the downloaded models"
    script:
        "../scripts/credits.py"


rule downloads_all:
    input:
        rules.downloads.output,
        rules.credits.output,


rule meshes:
    input:
        takes("meshes", sources=sources_of, companions=companions_of),
    output:
        directory("results/meshes/{objects}"),
        record="results/records/meshes/{objects}.json",
    log:
        "logs/meshes/{objects}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        **phase_of("meshes").written_values(PARAMETERS),
        key=key_of_job,
        seed=0 if PARAMETERS.meshes.turns == "none" else PARAMETERS.seed,
        models=models_of,
    message:
        "preparing {wildcards.objects}"
    script:
        "../scripts/meshes.py"
