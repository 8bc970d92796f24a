"""The paper under all its readings: what it leaves open, and what each choice does to its results."""

from __future__ import annotations

from readings.design import reading_conditions
from visuohaptic.studies.study import NOT_OF_RESULTS, Step, Study

STUDY = Study(
    "readings",
    "The paper under all its readings",
    reading_conditions,
    steps=(
        Step(
            "readings",
            "readings.summary:make_readings",
            ("results/readings.parquet", "reports/readings.json"),
        ),
        Step(
            "readings_page",
            "readings.page:make_readings_page",
            ("reports/readings.html",),
            takes=("results/readings.parquet",),
            is_shown=False,
        ),
        # One dot of the page: `snakemake -j2 results/reading/r017.json`.
        Step(
            "reading",
            "readings.one:make_reading",
            ("results/reading/{condition}.json",),
            needs={"exclude": NOT_OF_RESULTS},
            is_shown=False,
        ),
    ),
    has_figures=False,
    is_on_request=True,
)
