"""The numbers behind the report: `reports/metrics.json`, and tables that DVC can plot."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa

from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.recognition.summary import summarise
from visuohaptic.tables.phases import PREDICTIONS, SCORES
from visuohaptic.tables.schema import read_table

SIGNIFICANT_DIGITS = 6

HEADLINE_CLASSIFIER = "support_vector_machine"


def make_metrics(
    scores: Sequence[str | Path],
    predictions: Sequence[str | Path],
    metrics: str | Path,
    headline: str | Path,
    accuracy: str | Path,
    confusion: str | Path,
    intervals: IntervalParameters,
    seed: int,
    parameters: Mapping[str, Any],
) -> None:
    """Write the metrics file, its headline and two plot tables; they hold no seconds, so a rerun gives the same bytes.

    The metrics file names the `parameters` of the run, so that it can be compared with others.
    """
    predicted = read_table(PREDICTIONS, predictions)
    summary = round_numbers(summarise(read_table(SCORES, scores), predicted, intervals, seed))
    Path(metrics).parent.mkdir(parents=True, exist_ok=True)
    held = {**summary, "parameters": parameters}
    for path, values in ((metrics, held), (headline, headline_of(summary))):
        Path(path).write_text(json.dumps(values, indent=2, sort_keys=True) + "\n", encoding="utf-8")
    _write_csv(accuracy, _accuracy_rows(summary))
    _write_csv(confusion, _confusion_rows(predicted))


def headline_of(summary: Mapping[str, Any]) -> dict[str, Any]:
    """Give the figures of `summarise` that a table of many runs has room for.

    By pipeline: the accuracy by each strategy, of the support vector machine or else the first
    classifier, and the lead of fixation over the others with its p value; and ``objects``.
    """
    found: dict[str, Any] = {}
    for pipeline, strategies in summary["results"].items():
        classifiers = list(next(iter(strategies.values())))
        chosen = HEADLINE_CLASSIFIER if HEADLINE_CLASSIFIER in classifiers else classifiers[0]
        cells = {name: cells[chosen] for name, cells in strategies.items() if chosen in cells}
        leads = summary["comparisons"].get(pipeline, {}).get(chosen, {})
        found["objects"] = max(cell["objects"] for cell in cells.values())
        found[pipeline] = {
            **{name: cell["accuracy"]["mean"] for name, cell in cells.items()},
            **{f"lead over {name}": lead["difference"]["mean"] for name, lead in leads.items()},
            **{f"p over {name}": lead["p_value"] for name, lead in leads.items()},
        }
    return found


def round_numbers(value: Any) -> Any:
    """Round every number to `SIGNIFICANT_DIGITS`, however deep it lies in what JSON can hold.

    Digits that differ between processors say nothing.
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
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as stream:
        csv.writer(stream, lineterminator="\n").writerows(rows)
