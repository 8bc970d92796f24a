"""Ablations: one part of the method left out or exchanged → what is left of the accuracy.

Takes results/meshes/, results/fixations/, results/touches/ and results/features/, each ablation as
late a table as it allows; gives results/ablation/, results/ablations.parquet and reports/ablations.json.
A run makes none of them: `snakemake -j2 ablations_all` does, and from then on the report shows them and
every run keeps them current, until they are deleted. `snakemake -j1 results/ablation/wavelet.parquet`
runs one alone.
"""

ABLATION_FIGURES = ["results/ablations.parquet", "reports/ablations.json"]

VALUES_OF_RULES["ablation"] = {"ablation": list(ABLATIONS)}


rule ablations_all:
    input:
        ABLATION_FIGURES,


rule ablation:
    input:
        meshes=sources_of_ablation("meshes"),
        fixations=sources_of_ablation("fixations"),
        touches=sources_of_ablation("touches"),
        features=sources_of_ablation("features"),
        code=code_of("ablation.py"),
    output:
        "results/ablation/{ablation}.parquet",
        record="results/records/ablation/{ablation}.json",
    log:
        "logs/ablation/{ablation}.log",
    wildcard_constraints:
        ablation="|".join(ABLATIONS),
    conda:
        "../envs/visuohaptic.yaml"
    params:
        parameters=PARAMETERS.model_dump(exclude={"workflow", "meshes", "cost"}),
    message:
        "measuring the ablation {wildcards.ablation}"
    script:
        "../scripts/ablation.py"


rule ablations:
    input:
        parts=expand("results/ablation/{ablation}.parquet", ablation=ABLATIONS),
        code=code_of("ablations.py"),
    output:
        ablations="results/ablations.parquet",
        metrics="reports/ablations.json",
        record="results/records/ablations.json",
    log:
        "logs/ablations.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        intervals=PARAMETERS.recognition.intervals.model_dump(),
        seed=PARAMETERS.seed,
    message:
        "comparing the ablations with the whole method"
    script:
        "../scripts/ablations.py"
