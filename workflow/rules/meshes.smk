"""Meshes: models as they come → one clean, centred, coloured surface of unit size an object.

Takes meshes/catalogue.csv, meshes/paper/, meshes/own/, and downloads what the set lacks;
gives results/meshes/<class>/<object>.ply.
"""


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
    threads: 2
    params:
        models=[DOWNLOADED[key] for key in sorted(DOWNLOADED)],
        cache=".cache/models",
    message:
        "bringing the models that the set needs"
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
