"""Meshes: models as they come → one clean, centred, coloured surface of unit size an object.

Takes meshes/catalogue.csv, meshes/paper/, meshes/own/, and downloads what the set lacks;
gives results/meshes/<class>/<object>.ply.
"""

DOWNLOADED = {
    key: model
    for key, model in CATALOGUED.items()
    if not Path("meshes/paper", f"{key}.ply.gz").exists()
}


def source_of(wildcards):
    """Give the file that an object's model comes from, and what lies beside it."""
    if wildcards.object in OWN:
        return [OWN[wildcards.object], *companions(OWN[wildcards.object])]
    folder = "downloaded" if wildcards.object in DOWNLOADED else "paper"
    return [f"meshes/{folder}/{wildcards.object}.ply.gz"]


rule meshes_all:
    input:
        expand("results/meshes/{object}.ply", object=OBJECTS),


rule downloads:
    input:
        code=code_of("downloads.py"),
    output:
        models=expand("meshes/downloaded/{object}.ply.gz", object=sorted(DOWNLOADED)),
        credits="meshes/downloaded/credits.csv",
    log:
        "logs/downloads.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        models=[DOWNLOADED[key] for key in sorted(DOWNLOADED)],
        cache=".cache/models",
    threads: 2
    message:
        "bringing {params.models[0].category} and other models from where they are published"
        if DOWNLOADED
        else "no model to download"
    script:
        "../scripts/downloads.py"


rule meshes:
    input:
        source=source_of,
        code=code_of("meshes.py"),
    output:
        "results/meshes/{object}.ply",
    log:
        "logs/meshes/{object}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        model=lambda wildcards: CATALOGUED.get(wildcards.object),
        meshes=PARAMETERS.meshes.model_dump(exclude={"set"}),
    message:
        "preparing {wildcards.object}"
    script:
        "../scripts/meshes.py"
