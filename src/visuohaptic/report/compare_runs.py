"""Differences between runs in parameters and in accuracy, from their files `reports/metrics.json`."""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Iterator, Sequence
from pathlib import Path
from string import ascii_uppercase
from typing import Annotated, Any

import numpy as np
import pandas as pd
from pydantic import BaseModel, Field, PositiveFloat, ValidationError

from meshreaders.base.regular_files import read_regular
from visuohaptic.base.errors import ReportError
from visuohaptic.base.optional_packages import require
from visuohaptic.evaluation.intervals import compare_paired, plain_comparison
from visuohaptic.parameters import leaves
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import Estimate
from visuohaptic.report.run import METRICS

LARGEST_BYTES = 100 * 10**6
"""Largest size of a file of metrics; a run of 142 objects writes some megabytes."""

CELL = ["pipeline", "strategy", "classifier"]
VALUE = ["value", "low", "high"]
DIFFERENCE = ["difference", "difference_low", "difference_high"]
NEW_CLASSES = ["new_classes_low", "new_classes_high", "p_value_new_classes"]
COLUMNS = ["parameter", *CELL, "run", *VALUE, *DIFFERENCE, "p_value", *NEW_CLASSES, "objects"]


class Measured(BaseModel):
    """The accuracy of one classifier; `by_object` maps objects to accuracy and weight."""

    accuracy: Estimate
    by_object: dict[str, tuple[Annotated[float, Field(ge=0, le=1)], PositiveFloat]]


class Metrics(BaseModel):
    """The parameters of a run, and its results by pipeline, strategy and classifier."""

    parameters: dict[str, Any]
    results: dict[str, dict[str, dict[str, Measured]]]


def read_metrics(source: str) -> Metrics:
    """Read the metrics of a run.

    Parameters
    ----------
    source : str
        A metrics file, the folder of a run, or else a DVC experiment or Git revision of this repository.

    Raises
    ------
    ReportError
        If the source does not exist or holds no metrics of this version.
    """
    path = Path(source)
    try:
        if path.exists() or path.suffix == ".json":
            file = path / METRICS if path.is_dir() else path
            text = read_regular(file, LARGEST_BYTES).decode("utf-8")
        else:
            text = _ask_dvc("read", METRICS, rev=source)
        return Metrics.model_validate_json(text)
    except OSError as error:
        raise ReportError(f"{error.filename} can't be read: {error.strerror}.") from error
    except (UnicodeDecodeError, ValidationError):
        raise ReportError(f"{source} is no {METRICS} of this version.") from None


def list_experiments() -> list[str]:
    """Return the names of this repository's DVC experiments; raises `ReportError` if there are none."""
    names = [row["Experiment"] for row in _ask_dvc("exp_show") if row.get("Experiment")]
    if not names:
        raise ReportError("DVC keeps no experiment here; `dvc exp run` makes one.")
    return names


def _ask_dvc(function: str, *arguments: str, **named: str) -> Any:
    require("workflow", "dvc")
    import dvc.api  # type: ignore[import-untyped]
    from dvc.exceptions import DvcException  # type: ignore[import-untyped]

    try:
        return getattr(dvc.api, function)(*arguments, **named)
    # DVC and the Git libraries below it raise many types; the cause is a wrong name.
    except (DvcException, OSError, ValueError, KeyError) as error:
        subject = f"{named['rev']} is no file, and DVC" if named else "DVC"
        raise ReportError(f"{subject} can't read it here ({error}); see `dvc exp show`.") from error


def compare_runs(runs: Sequence[Metrics]) -> pd.DataFrame:
    """Compare runs A, B, … with run A.

    Parameters
    ----------
    runs : sequence of Metrics
        2 to 26 runs; the first is A.

    Returns
    -------
    pandas.DataFrame
        Columns `COLUMNS`, with one row per run for each parameter that differs and for each accuracy. ``value`` is a
        parameter as JSON, or an accuracy with its interval. ``difference`` is the run's accuracy minus that of A over
        the ``objects`` that both tested. It has intervals and p values, of new objects and of new classes.

    Raises
    ------
    ReportError
        If there are fewer than 2 or more than 26 runs, or a run shares no classifier with A.
    """
    if not 2 <= len(runs) <= len(ascii_uppercase):
        raise ReportError(f"Runs named: {len(runs)}; 2 to {len(ascii_uppercase)} are allowed.")
    rows = [*_parameter_rows(runs), *_accuracy_rows(runs)]
    return pd.DataFrame(rows, columns=COLUMNS).astype({"objects": "Int64"})


def _parameter_rows(runs: Sequence[Metrics]) -> Iterator[dict[str, object]]:
    written = [dict(leaves(run.parameters)) for run in runs]
    for name in dict.fromkeys(name for values in written for name in values):
        texts = [json.dumps(values.get(name), ensure_ascii=False) for values in written]
        if len({*texts}) > 1:
            for run, text in zip(ascii_uppercase, texts, strict=False):
                yield {"parameter": name, "run": run, "value": text}


def _accuracy_rows(runs: Sequence[Metrics]) -> Iterator[dict[str, object]]:
    by_cell = [
        {
            (pipeline, strategy, classifier): measured
            for pipeline, strategies in run.results.items()
            for strategy, classifiers in strategies.items()
            for classifier, measured in classifiers.items()
        }
        for run in runs
    ]
    first = by_cell[0]
    for run, cells in zip(ascii_uppercase, by_cell, strict=False):
        if not cells.keys() & first.keys():
            raise ReportError(f"Run {run} has no pipeline, strategy and classifier that A has.")
    for cell in dict.fromkeys(cell for cells in by_cell for cell in cells):
        for run, cells in zip(ascii_uppercase, by_cell, strict=False):
            if cell not in cells:
                continue
            accuracy = cells[cell].accuracy
            figures = (accuracy.mean, accuracy.low, accuracy.high)
            row: dict[str, object] = dict(
                zip([*CELL, "run", *VALUE], [*cell, run, *figures], strict=True)
            )
            if cells is not first and cell in first:
                row |= _difference(cells[cell].by_object, first[cell].by_object)
            yield row


def _difference(
    later: dict[str, tuple[float, float]], first: dict[str, tuple[float, float]]
) -> dict[str, object]:
    """Return later minus first over the objects of both runs; without an interval if all accuracies are equal."""
    objects = sorted(later.keys() & first.keys())
    if not objects:
        return {"objects": 0}
    before, weights = np.array([first[name] for name in objects]).T
    after = np.array([later[name][0] for name in objects])
    classes = [name.partition("/")[0] for name in objects]
    compared = plain_comparison(
        compare_paired(after, before, weights, IntervalParameters(), classes)
    )
    is_equal = np.array_equal(before, after)
    wide = compared["difference_new_classes"]
    figures = (0.0, None, None) if is_equal else compared["difference"].values()
    ends = (None, None) if is_equal else (wide["low"], wide["high"])
    return {
        **dict(zip(DIFFERENCE, figures, strict=True)),
        "p_value": compared["p_value"],
        **dict(zip(NEW_CLASSES, (*ends, compared["p_value_new_classes"]), strict=True)),
        "objects": len(objects),
    }


def comparison_lines(table: pd.DataFrame) -> Iterator[str]:
    """Yield the lines of a comparison: runs, parameters that differ, and accuracies.

    `table` is a result of `compare_runs` with a further column ``source``, the name of the run.
    """
    runs = table.drop_duplicates("run")
    yield from (f"{run}  {source}" for run, source in zip(runs.run, runs.source, strict=True))
    changed = table[table.parameter.notna()]
    yield from ("", "Parameters that differ:" if len(changed) else "No parameter differs.")
    for name, run, value in zip(changed.parameter, changed.run, changed.value, strict=True):
        line = f"{name}  {run}  {value}"
        yield from textwrap.wrap(line, 80, subsequent_indent="  ", break_long_words=False)
    yield from (
        "",
        "Correctly classified (%), with 95 % intervals over objects, without the",
        "variation of training objects:",
    )
    for (pipeline, strategy), rows in table.groupby(["pipeline", "strategy"], sort=False):
        yield from ("", f"pipeline {pipeline}, strategy {strategy}")
        shown = rows[["classifier", "run"]].assign(accuracy=_written(rows[VALUE], ".1f"))
        shown["minus A"] = _written(rows[DIFFERENCE], "+.1f")
        shown["objects"] = rows.objects.astype("string").fillna("")
        yield from shown.to_string(index=False).splitlines()


def _written(figures: pd.DataFrame, form: str) -> list[str]:
    """Return each figure with its interval, in per cent; an empty text where the figure is missing."""
    texts = []
    for mean, low, high in (100 * figures.astype(float)).itertuples(index=False):
        ends = "" if math.isnan(low) else f" ({low:{form}} to {high:{form}})"
        text = "equal" if mean == 0 and math.isnan(low) else f"{mean:{form}}{ends}"
        texts.append("" if math.isnan(mean) else text)
    return texts
