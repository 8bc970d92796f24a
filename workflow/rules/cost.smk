"""Cost: what accuracy costs in time, setting by setting.

Takes results/meshes/, results/fixations/ and results/features/; gives results/cost/errors/ (a file a
family of settings; the same numbers in every run), results/cost/seconds.parquet (timed side by side in one
job), results/cost.parquet, which joins the two and marks the front, and reports/cost.json. A run makes none
of them: `snakemake -j2 cost_all` does, and from then on the report shows them and every run
keeps them current, until they are deleted.
"""

COST_FAMILIES = list(FAMILIES)
VALUES_OF_RULES["cost_errors"] = {"family": COST_FAMILIES}
COST_FIGURES = ["results/cost.parquet"]
COST_SAMPLE = OBJECTS[:: max(1, -(-len(OBJECTS) // PARAMETERS.cost.objects))]
# Every parameter that has a say in what is tried; the pipelines that a run runs have none.
COST_PARAMETERS = PARAMETERS.model_dump(
    exclude={
        "workflow": True,
        "meshes": True,
        "probing": True,
        "recognition": {"pipelines"},
    }
)


rule cost_all:
    input:
        COST_FIGURES,
        "reports/cost.json",


rule cost_errors:
    input:
        meshes=expand("results/meshes/{object}.ply", object=OBJECTS),
        fixations=parts_of("fixations"),
        features=parts_of("features"),
        code=code_of("cost_errors.py"),
    output:
        errors="results/cost/errors/{family}.parquet",
        described=directory("results/cost/features/{family}"),
        record="results/records/cost_errors/{family}.json",
    log:
        "logs/cost/{family}.log",
    wildcard_constraints:
        family="|".join(COST_FAMILIES),
    conda:
        "../envs/visuohaptic.yaml"
    params:
        parameters=COST_PARAMETERS,
    message:
        "measuring the error rates of family {wildcards.family}"
    script:
        "../scripts/cost_errors.py"


rule cost_seconds:
    input:
        meshes=expand("results/meshes/{object}.ply", object=COST_SAMPLE),
        described=expand("results/cost/features/{family}", family=COST_FAMILIES),
        code=code_of("cost_seconds.py"),
    output:
        "results/cost/seconds.parquet",
        record="results/records/cost_seconds.json",
    log:
        "logs/cost/seconds.log",
    conda:
        "../envs/visuohaptic.yaml"
    # It works on one, and takes all there are, so that no other job is in its way.
    threads: all_cores
    params:
        parameters=COST_PARAMETERS,
        families=COST_FAMILIES,
    message:
        "timing all settings side by side"
    script:
        "../scripts/cost_seconds.py"


rule cost:
    input:
        errors=expand("results/cost/errors/{family}.parquet", family=COST_FAMILIES),
        seconds="results/cost/seconds.parquet",
        code=code_of("cost.py"),
    output:
        cost="results/cost.parquet",
        metrics="reports/cost.json",
        record="results/records/cost.json",
    log:
        "logs/cost.log",
    conda:
        "../envs/visuohaptic.yaml"
    message:
        "weighing accuracy against time"
    script:
        "../scripts/cost.py"
