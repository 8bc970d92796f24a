"""The figures of the report: `reports/metrics.json`, and tables that DVC can plot."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pyarrow as pa

from visuohaptic.base.atomic_files import atomic_file, atomic_write_text
from visuohaptic.base.csv_cells import csv_cell
from visuohaptic.evaluation.own_fixations import count_own_fixations
from visuohaptic.evaluation.summary import summarise
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.tables.phases import PREDICTIONS, SCORES, TOUCHES, VIEWS
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.studies import STUDY

SIGNIFICANT_DIGITS = 6


def make_metrics(
    scores: Sequence[str | Path],
    predictions: Sequence[str | Path],
    touches: Sequence[str | Path],
    views: Sequence[str | Path],
    metrics: str | Path,
    accuracy: str | Path,
    confusion: str | Path,
    intervals: IntervalParameters,
    fixations: int,
    parameters: Mapping[str, Any],
    drawn: Sequence[str | Path] = (),
) -> None:
    """Write the metrics file and two tables for plots.

    None of the files holds seconds, so a rerun writes the same bytes.

    Parameters
    ----------
    scores, predictions : sequence of paths
        Files of `tables.SCORES` and `tables.PREDICTIONS`.
    touches, views : sequence of paths
        Files of `tables.TOUCHES` and `tables.VIEWS`.
    metrics : path
        JSON to write: the figures of `summarise`, those of `count_own_fixations` as ``own_fixations`` (None without
        touches by fixation), and the `parameters` of the run.
    accuracy : path
        CSV to write: accuracy per pipeline, strategy and classifier.
    confusion : path
        CSV to write: true and predicted class of each prediction.
    intervals : IntervalParameters
        The confidence of the intervals.
    fixations : int
        The number of fixations per view.
    parameters : mapping
        The parameters of the run, so that metrics of several runs can be compared.
    drawn : sequence of paths
        Files of `tables.STUDY` with further draws of random strategies.
    """
    predicted = read_table(PREDICTIONS, predictions)
    further = read_table(STUDY, drawn) if drawn else None
    summary = summarise(read_table(SCORES, scores), predicted, intervals, further)
    touched, seen = read_table(TOUCHES, touches, ["rank"]), read_table(VIEWS, views, [])
    own = count_own_fixations(touched, seen, fixations)
    summary = round_numbers({**summary, "own_fixations": None if own is None else asdict(own)})
    text = json.dumps({**summary, "parameters": parameters}, indent=2, sort_keys=True) + "\n"
    atomic_write_text(metrics, text)
    _write_csv(accuracy, _accuracy_rows(summary))
    _write_csv(confusion, _confusion_rows(predicted))


def round_numbers(value: Any) -> Any:
    """Round every float in nested dicts, lists and tuples to `SIGNIFICANT_DIGITS`; tuples become lists.

    Later digits may differ between processors.
    """
    if isinstance(value, dict):
        return {key: round_numbers(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [round_numbers(item) for item in value]
    if isinstance(value, float):
        return float(f"{value:.{SIGNIFICANT_DIGITS}g}")
    return value


def _accuracy_rows(summary: dict[str, Any]) -> Iterable[Sequence[object]]:
    yield ("label", "pipeline", "strategy", "classifier", "accuracy", "low", "high")
    for pipeline, strategies in summary["results"].items():
        for strategy, classifiers in strategies.items():
            for classifier, figures in classifiers.items():
                interval = figures["accuracy"]
                ends = (interval["mean"], interval["low"], interval["high"])
                label = f"{classifier} by {strategy}, {pipeline}".replace("_", " ")
                yield (label, pipeline, strategy, classifier, *ends)


def _confusion_rows(predictions: pa.Table) -> Iterable[Sequence[object]]:
    names = ("pipeline", "strategy", "classifier", "class", "predicted")
    yield names
    yield from zip(*(predictions.column(name).to_pylist() for name in names), strict=True)


def _write_csv(path: str | Path, rows: Iterable[Sequence[object]]) -> None:
    with (
        atomic_file(path) as unfinished,
        unfinished.open("w", newline="", encoding="utf-8") as stream,
    ):
        csv.writer(stream, lineterminator="\n").writerows(
            [csv_cell(value) for value in row] for row in rows
        )
