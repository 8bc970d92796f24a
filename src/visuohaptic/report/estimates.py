"""Figures with their intervals: read from rows or files, and written in the same way everywhere on the page."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from markupsafe import Markup
from pydantic import ValidationError

from visuohaptic.base.errors import ReportError
from visuohaptic.evaluation.intervals import Interval, PairedComparison
from visuohaptic.report.wording import percent, points

Row = Mapping[str, Any]
"""A row of a table, by column."""

Made = TypeVar("Made")


@dataclass(frozen=True)
class Estimate:
    """A mean with its intervals of new objects and of new classes; missing numbers are None.

    Attributes
    ----------
    mean : float
        The mean.
    low, high : float, optional
        Ends of the interval of new objects of the same classes.
    p_value : float, optional
        Only of a lead: the p value that belongs to this interval.
    new_classes_low, new_classes_high : float, optional
        Ends of the interval of new classes.
    p_value_new_classes : float, optional
        Only of a lead: the p value that belongs to the interval of new classes.
    """

    mean: float
    low: float | None = None
    high: float | None = None
    p_value: float | None = None
    new_classes_low: float | None = None
    new_classes_high: float | None = None
    p_value_new_classes: float | None = None

    def holds(self, value: float) -> bool:
        """Return whether a value lies within the interval, ends included."""
        return self.low is not None and self.high is not None and self.low <= value <= self.high


def estimate_of(row: Row, name: str) -> Estimate | None:
    """Return the value of column `name` with its interval; None without a value.

    The ends are in the columns ``NAME_low`` and ``NAME_high``, or else in ``low`` and ``high``.
    """
    if row[name] is None:
        return None
    low, high = (row.get(f"{name}_{end}", row.get(end)) for end in ("low", "high"))
    return Estimate(row[name], low, high)


def read_json(path: Path, make: Callable[[Any], Made], fault: str, way_out: str) -> Made:
    """Read a JSON file and return `make` of its value.

    Parameters
    ----------
    path : Path
    make : callable
        Converts the value that the JSON text holds.
    fault : str
        The fault to name if reading fails, such as ``holds no figures of study trust``.
    way_out : str
        The advice to the reader, such as ``run `snakemake -j2 trust_all` again``.

    Raises
    ------
    ReportError
        If the file can't be read or `make` fails on its value: one sentence with path, fault, cause and way out.
    """
    try:
        return make(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError, LookupError, AttributeError) as error:
        why = " ".join(_first_fault(error).split())
        raise ReportError(f"{path} {fault} ({why}); {way_out}.") from error


def _first_fault(error: Exception) -> str:
    """Return the first fault of values that do not fit a model, or the error's own words."""
    if not isinstance(error, ValidationError):
        return str(error)
    first = error.errors()[0]
    return f"{'.'.join(map(str, first['loc']))}: {first['msg']}"


def estimate(interval: Interval, new_classes: Interval | None = None) -> Estimate:
    """Return an interval as `Estimate`, with that of new classes; ends that are NaN, as for a single object, become None."""
    wide = (None, None) if new_classes is None else (new_classes.low, new_classes.high)
    low, high, wide_low, wide_high = map(_known, (interval.low, interval.high, *wide))
    return Estimate(interval.mean, low, high, new_classes_low=wide_low, new_classes_high=wide_high)


def lead(comparison: PairedComparison) -> Estimate:
    """Return a paired comparison as `Estimate`, with both intervals and both p values."""
    return replace(
        estimate(comparison.difference, comparison.difference_new_classes),
        p_value=comparison.p_value,
        p_value_new_classes=_known(comparison.p_value_new_classes),
    )


def measured(entry: Row, name: str) -> Estimate:
    """Return a figure of ``reports/metrics.json`` from its entry, with both intervals and, of a lead, both p values.

    `name` is the key of the interval of new objects; that of new classes has ``_new_classes`` after it.
    """
    wide = entry[f"{name}_new_classes"]
    p_values = (
        (entry["p_value"], entry["p_value_new_classes"]) if name == "difference" else (None, None)
    )
    return Estimate(
        **entry[name],
        p_value=p_values[0],
        new_classes_low=wide["low"],
        new_classes_high=wide["high"],
        p_value_new_classes=p_values[1],
    )


def _known(value: float | None) -> float | None:
    """Return a number; None for NaN."""
    return None if value is None or math.isnan(value) else value


def with_interval(figure: Estimate, write: Callable[[float], str], unit: str = "") -> str:
    """Return a figure as part of a sentence, such as ``70.0 % (65.0 % to 75.0 %)``.

    `write` formats each number; `unit` follows the mean only. Without an interval there are no brackets.
    """
    if figure.low is None or figure.high is None:
        return write(figure.mean) + unit
    return f"{write(figure.mean)}{unit} ({write(figure.low)} to {write(figure.high)})"


def both_intervals(figure: Estimate, write: Callable[[float], str]) -> str:
    """Return the intervals in brackets, such as ``(new objects 65.0 % to 75.0 %, new classes 60.0 % to 80.0 %)``.

    `write` formats each number. Intervals that are written alike stand once. Empty without intervals.
    """
    ends = {
        "new objects": (figure.low, figure.high),
        "new classes": (figure.new_classes_low, figure.new_classes_high),
    }
    intervals = {
        population: f"{write(low)} to {write(high)}"
        for population, (low, high) in ends.items()
        if low is not None and high is not None
    }
    if len(intervals) == 2 and len({*intervals.values()}) == 1:
        return f"(new objects and new classes {intervals['new objects']})"
    written = ", ".join(f"{population} {interval}" for population, interval in intervals.items())
    return f"({written})" if written else ""


def share_above_interval(figure: Estimate) -> Markup:
    """Return `above_interval` of a share, in per cent."""
    return above_interval(figure, percent)


def points_above_interval(figure: Estimate) -> Markup:
    """Return `above_interval` of a difference of shares, in percentage points with sign."""
    return above_interval(figure, points)


def above_interval(figure: Estimate, write: Callable[[float], str]) -> Markup:
    """Return a figure as HTML for a cell of a table, with its interval on a line below.

    `write` formats each number.
    """
    mean = Markup('<data value="{}">{}</data>').format(figure.mean, write(figure.mean))
    if figure.low is None or figure.high is None:
        return mean
    ends = f"{write(figure.low)} to {write(figure.high)}"
    return mean + Markup('<span class="interval">{}</span>').format(ends)
