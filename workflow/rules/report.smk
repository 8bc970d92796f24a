"""Report: every table → one HTML page, the numbers behind it, and plots for DVC.

Reads results/ and, if they exist, logs/ and credits. Writes reports/report.html, reports/metrics.json and
reports/plots/.
"""

TEMPLATES = in_clone(
    sorted(
        file
        for folder in ("pictures", "report")
        for file in Path(shipped(f"src/visuohaptic/{folder}/templates")).glob("*.*")
    )
)
# Sections of studies, their templates, and the results that are kept beside them.
SECTIONS = section_files(STUDY_FOLDERS)
SECTION_FILES = in_clone(
    os.path.relpath(file)
    for section in SECTIONS.values()
    for pattern in ("templates/*.*", "kept_*.*")
    for file in sorted(section.parent.glob(pattern))
)
# Files that `visuohaptic evaluate` and `make test-hard` write.
MEASURED_BESIDE = ["reports/evaluation.parquet", "docs/figures/hard_cases.json"]


rule metrics:
    input:
        takes(
            "metrics",
            scores=files_of("scores", "{pipeline}/{strategy}"),
            predictions=files_of("predictions", "{pipeline}/{strategy}"),
            touches=files_of("touches"),
            views=files_of("views"),
            drawn=study_blocks("random_draws"),
        ),
    output:
        metrics=report(
            "reports/metrics.json",
            caption="../report/metrics.rst",
            category="Recognition",
        ),
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
        record="results/records/metrics.json",
    log:
        "logs/metrics.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_job,
        intervals=PARAMETERS.recognition.intervals.model_dump(),
        # Without sections that no accuracy depends on.
        parameters=PARAMETERS.model_dump(mode="json", exclude={"workflow", "cost"}),
    message:
        "summarising the scores"
    script:
        "../scripts/metrics.py"


rule report:
    input:
        takes(
            "report",
            own=SECTIONS.values(),
            metrics="reports/metrics.json",
            predictions=files_of("predictions", "{pipeline}/{strategy}"),
            views=files_of("views"),
            fixations=places_of(files_of),
            touches=files_of("touches"),
            features=files_of("features"),
            effects=[*files_of("effects/views"), *files_of("effects/touches")],
            meshes=meshes_of(),
            studies=[file for study in STUDIES_OF_RUN for file in study.shown],
            frontier="results/frontier.parquet",
            drawn=study_blocks("random_draws"),
            stability=files_of("stability", "{objects}"),
            pictures=files_of("pictures", "{objects}"),
            # Not part of `all`; the report shows the files that are there.
            more_studies=files_of_more_studies,
            measured=in_clone(filter(os.path.exists, MEASURED_BESIDE)),
            credits=CREDITS,
            templates=[*TEMPLATES, *SECTION_FILES],
        ),
    output:
        page=report(
            "reports/report.html", caption="../report/page.rst", category="Report"
        ),
        headline="reports/headline.json",
        record="results/records/report.json",
    log:
        "logs/report.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        key=key_of_job,
        parameters=PARAMETERS.model_dump(exclude={"workflow"}),
        objects=OBJECTS,
        own_objects=sorted(OWN),
    message:
        "writing the report"
    script:
        "../scripts/report.py"


rule report_all:
    input:
        rules.metrics.output,
        rules.report.output,
