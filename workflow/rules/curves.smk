"""Curves: surfaces → long sequences of touches by every strategy → accuracy over touches.

Takes results/meshes/; gives results/curve_features/, results/curves/, results/touch_curves.parquet,
results/touches_needed.parquet and reports/curves.json. A run makes none of them, for six strategies are
trained and tested with every number of touches: `snakemake -j2 curves_all` does, and from then on the
report shows them and every run keeps them current, until they are deleted.
"""

from visuohaptic.fixations.probing import STRATEGIES
from visuohaptic.studies.curves.settings import LONGEST_SEQUENCE

CURVE_FIGURES = [
    "results/touch_curves.parquet",
    "results/touches_needed.parquet",
    "reports/curves.json",
]

CURVE_STRATEGIES = [*STRATEGIES.names, "adaptive"]
VALUES_OF_RULES["curves"] = {"strategy": CURVE_STRATEGIES}


rule curves_all:
    input:
        CURVE_FIGURES,


rule curve_features:
    input:
        mesh="results/meshes/{object}.ply",
        code=code_of("curve_features.py"),
    output:
        "results/curve_features/{object}.parquet",
        record="results/records/curve_features/{object}.json",
    log:
        "logs/curve_features/{object}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        viewpoints=PARAMETERS.viewpoints.model_dump(),
        rendering=PARAMETERS.rendering.model_dump(),
        attention=PARAMETERS.attention.model_dump(exclude={"fixations"}),
        sensor=PARAMETERS.sensor.model_dump(),
        scene=PARAMETERS.scene.model_dump(),
        features=PARAMETERS.features.model_dump(),
        seed=PARAMETERS.seed,
    message:
        "touching {wildcards.object} at length, by every strategy"
    script:
        "../scripts/curve_features.py"


rule curves:
    input:
        features=expand("results/curve_features/{object}.parquet", object=OBJECTS),
        code=code_of("curves.py"),
    output:
        "results/curves/{pipeline}/{strategy}.parquet",
        record="results/records/curves/{pipeline}/{strategy}.json",
    log:
        "logs/curves/{pipeline}/{strategy}.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        recognition=PARAMETERS.recognition.model_dump(
            exclude={"pipelines", "classifiers", "touches", "intervals"}
        ),
        focus_radius=PARAMETERS.attention.focus_radius,
        touches=LONGEST_SEQUENCE,
        seed=PARAMETERS.seed,
    message:
        "naming objects after 1 to {params.touches} touches by {wildcards.strategy}, pipeline {wildcards.pipeline}"
    script:
        "../scripts/curves.py"


rule touches_needed:
    input:
        curves=expand(
            "results/curves/{pipeline}/{strategy}.parquet",
            pipeline=PARAMETERS.recognition.pipelines,
            strategy=CURVE_STRATEGIES,
        ),
        code=code_of("touches_needed.py"),
    output:
        points="results/touch_curves.parquet",
        needed="results/touches_needed.parquet",
        figures="reports/curves.json",
        record="results/records/touches_needed.json",
    log:
        "logs/touches_needed.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        intervals=PARAMETERS.recognition.intervals.model_dump(),
        seed=PARAMETERS.seed,
    message:
        "summing up the curves over touches"
    script:
        "../scripts/touches_needed.py"
