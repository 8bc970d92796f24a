"""Guards: the run's tables → whether what the report claims is an error of the code behind it.

Takes results/features/, results/fixations/ and results/meshes/; gives results/guards_of_training.parquet, beside the
jobs of recognition. Rule `metrics` adds the guards of its figures: results/guards.parquet, which the report shows. Where
a guard failed, the page is kept and the run ends with status 1.
"""


rule guards_of_training:
    input:
        takes(
            "guards_of_training",
            features=files_of("features"),
            fixations=files_of("fixations"),
            meshes=meshes_of(),
        ),
    output:
        "results/guards_of_training.parquet",
        record="results/records/guards_of_training.json",
    log:
        "logs/guards_of_training.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_job,
        pipelines=list(PARAMETERS.recognition.pipelines),
        recognition=PARAMETERS.recognition.model_dump(
            exclude={"pipelines", "intervals"}
        ),
        seed=PARAMETERS.seed,
    message:
        "guarding training and random places"
    script:
        "../scripts/guards_of_training.py"


# After the report, so that the page is there to say what failed; another page changes nothing of that.
rule guards_hold:
    input:
        takes("guards_hold", guards="results/guards.parquet"),
        report=ancient("reports/report.html"),
    output:
        record="results/records/guards_hold.json",
    log:
        "logs/guards_hold.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_job,
    message:
        "reading what the guards found"
    script:
        "../scripts/guards_hold.py"
