"""Report: every table → one HTML page, the numbers behind it, and plots for DVC.

Takes results/ and, if they exist, logs/ and credits; gives reports/report.html,
reports/metrics.json and reports/plots/.
"""

TEMPLATES = in_clone(
    sorted(Path(shipped("src/visuohaptic/report/templates")).glob("*.*"))
)
# What `make test-hard` and `visuohaptic evaluate` measured on this machine.
MEASURED_BESIDE = ["reports/evaluation.parquet", "reports/precision.json"]


rule metrics:
    input:
        takes(
            "metrics",
            scores=files_of("scores", "{pipeline}/{strategy}"),
            predictions=files_of("predictions", "{pipeline}/{strategy}"),
            training="results/guards_of_training.parquet",
        ),
    output:
        metrics=report(
            "reports/metrics.json",
            caption="../report/metrics.rst",
            category="Recognition",
        ),
        headline="reports/headline.json",
        accuracy=report(
            "reports/plots/accuracy.csv",
            caption="../report/accuracy.rst",
            category="Recognition",
        ),
        confusion=report(
            "reports/plots/confusion.csv",
            caption="../report/confusion.rst",
            category="Recognition",
        ),
        guards="results/guards.parquet",
        record="results/records/metrics.json",
    log:
        "logs/metrics.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_job,
        intervals=PARAMETERS.recognition.intervals.model_dump(),
        seed=PARAMETERS.seed,
        # Those that no accuracy depends on are left out.
        parameters=PARAMETERS.model_dump(
            mode="json", exclude={"workflow", "cost", "gaze"}
        ),
    message:
        "summing up the scores, and guarding the sums"
    script:
        "../scripts/metrics.py"


rule report:
    input:
        takes(
            "report",
            metrics="reports/metrics.json",
            predictions=files_of("predictions", "{pipeline}/{strategy}"),
            views=files_of("views"),
            fixations=files_of("fixations"),
            touches=files_of("touches"),
            features=files_of("features"),
            effects=[*files_of("effects/views"), *files_of("effects/touches")],
            meshes=meshes_of(),
            studies=[file for study in STUDIES_OF_RUN for file in study.shown],
            stability=files_of("stability", "{objects}"),
            pictures=files_of("pictures", "{objects}"),
            guards="results/guards.parquet",
            # Only where recordings are given.
            gaze=GAZE_TABLES if RECORDED_GAZE else [],
            # Not part of `all`; once present they are shown in the report.
            measured=[
                *SHOWN_FILES,
                *in_clone(filter(os.path.exists, MEASURED_BESIDE)),
            ],
            credits=CREDITS,
            templates=TEMPLATES,
        ),
    output:
        report("reports/report.html", caption="../report/page.rst", category="Report"),
        record="results/records/report.json",
    log:
        "logs/report.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_job,
        parameters=PARAMETERS.model_dump(exclude={"workflow"}),
        objects=OBJECTS,
        studies=shown_studies,
    message:
        "writing the report"
    script:
        "../scripts/report.py"


rule report_all:
    input:
        rules.metrics.output,
        rules.guards_of_training.output,
        rules.report.output,
        rules.guards_hold.output,
