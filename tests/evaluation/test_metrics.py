"""Metrics of a run as files."""

import csv

import pyarrow.compute as pc
from recognition.synthetic import features_table

from visuohaptic.evaluation.metrics import make_metrics
from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.parameters import IntervalParameters, RecognitionParameters
from visuohaptic.tables.phases import PREDICTIONS, SCORES, TOUCHES, VIEWS
from visuohaptic.tables.schema import write_table

FEW = RecognitionParameters(protocol={"maximum_splits": 2}, classifiers=["naive_bayes"])


def test_a_class_that_a_spreadsheet_would_run_is_text_in_the_tables_for_plots(tmp_path):
    table = features_table()
    names = pc.replace_substring(table["class"], "class0", "=1+1")
    table = table.set_column(table.column_names.index("class"), "class", names)
    scores, predictions = run_pipeline(table, FEW, 0)
    write_table(SCORES, scores, tmp_path / "scores.parquet")
    write_table(PREDICTIONS, predictions, tmp_path / "predictions.parquet")
    write_table(TOUCHES, TOUCHES.arrow.empty_table(), tmp_path / "touches.parquet")
    write_table(VIEWS, VIEWS.arrow.empty_table(), tmp_path / "views.parquet")
    tables = (
        [tmp_path / f"{name}.parquet"] for name in ("scores", "predictions", "touches", "views")
    )
    make_metrics(
        *tables, tmp_path / "metrics.json",
        tmp_path / "accuracy.csv", tmp_path / "confusion.csv", IntervalParameters(), 5, {},
    )  # fmt: skip
    with (tmp_path / "confusion.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert {row["class"] for row in rows} == {"'=1+1", "class1", "class2", "class3"}
