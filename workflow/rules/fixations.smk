"""Fixations: surface and viewpoints → rendered views, saliency, and ordered probing locations.

Takes results/meshes/; gives the tables results/views/, results/fixations/ and
results/effects/views/ (effect log: why each effect of the view was needed, and its run time).
"""


rule fixations_all:
    input:
        parts_of("fixations"),
        parts_of("views"),
        parts_of("effects/views"),
        parts_of("records/fixations", "json"),


rule fixations:
    input:
        meshes="results/meshes/{objects}",
        code=code_of("fixations.py"),
    output:
        fixations="results/fixations/{objects}/{views}.parquet",
        views="results/views/{objects}/{views}.parquet",
        effects="results/effects/views/{objects}/{views}.parquet",
        record="results/records/fixations/{objects}/{views}.json",
    log:
        "logs/fixations/{objects}/{views}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        viewpoints_of_block=viewpoints_of,
        viewpoints=PARAMETERS.viewpoints.model_dump(),
        rendering=PARAMETERS.rendering.model_dump(),
        attention=PARAMETERS.attention.model_dump(),
        strategies=PARAMETERS.probing.strategies,
        # Only visual effects are passed, so a sensor effect does not re-render views.
        modes=PARAMETERS.scene.effects.model_dump(include=set(VISUAL_EFFECTS)),
        seed=PARAMETERS.seed,
    message:
        "looking at {wildcards.objects} and others from viewpoints {wildcards.views}"
    script:
        "../scripts/fixations.py"
