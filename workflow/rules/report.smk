"""Report: every table → one HTML page, the numbers behind it, and plots for DVC.

Takes results/; gives reports/report.html, reports/metrics.json and reports/plots/.
"""


rule report_all:
    input:
        "reports/report.html",
        "reports/metrics.json",
        "reports/plots/accuracy.csv",
        "reports/plots/confusion.csv",


rule metrics:
    input:
        scores=scores_of("scores"),
        predictions=scores_of("predictions"),
        code=code_of("metrics.py"),
    output:
        metrics="reports/metrics.json",
        accuracy="reports/plots/accuracy.csv",
        confusion="reports/plots/confusion.csv",
    log:
        "logs/metrics.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        intervals=PARAMETERS.recognition.intervals.model_dump(),
        seed=PARAMETERS.seed,
    message:
        "summing up the scores"
    script:
        "../scripts/metrics.py"


rule report:
    input:
        metrics="reports/metrics.json",
        predictions=scores_of("predictions"),
        views=parts_of("views"),
        fixations=parts_of("fixations"),
        touches=parts_of("touches"),
        code=code_of("report.py"),
        templates="src/visuohaptic/report/templates",
    output:
        "reports/report.html",
    log:
        "logs/report.log",
    conda:
        "../envs/visuohaptic.yaml"
    params:
        parameters=PARAMETERS.model_dump(),
        objects=OBJECTS,
    message:
        "writing the report"
    script:
        "../scripts/report.py"
