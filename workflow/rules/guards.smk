"""Guards: the run's tables → whether what the report claims is an error of the code behind it.

Takes results/features/, results/fixations/, results/meshes/, results/predictions/ and reports/metrics.json; gives
results/guards.parquet, which the report shows. Where a guard failed, the page is kept and the run ends with status 1.
"""


rule guards:
    input:
        takes(
            "guards",
            "guards.py",
            features=parts_of("features"),
            fixations=parts_of("fixations"),
            meshes=meshes_of(),
            predictions=scores_of("predictions"),
            metrics="reports/metrics.json",
        ),
    output:
        "results/guards.parquet",
        record="results/records/guards.json",
    log:
        "logs/guards.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("guards"),
        pipelines=list(PARAMETERS.recognition.pipelines),
        recognition=PARAMETERS.recognition.model_dump(
            exclude={"pipelines", "intervals"}
        ),
        seed=PARAMETERS.seed,
    message:
        "guarding the report's claim"
    script:
        "../scripts/guards.py"


# After the report, so that the page is there to say what failed; another page changes nothing of that.
rule guards_hold:
    input:
        takes("guards_hold", "guards_hold.py", guards="results/guards.parquet"),
        report=ancient("reports/report.html"),
    output:
        record="results/records/guards_hold.json",
    log:
        "logs/guards_hold.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_rule("guards_hold"),
    message:
        "reading what the guards found"
    script:
        "../scripts/guards_hold.py"
