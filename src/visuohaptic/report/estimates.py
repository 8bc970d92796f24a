"""Figures with their intervals: taken from a table's row or a file, and written in one way all over the page."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from markupsafe import Markup
from pydantic import ValidationError

from visuohaptic.base.errors import ReportError
from visuohaptic.evaluation.intervals import Interval
from visuohaptic.report.wording import percent, points

Row = Mapping[str, Any]
"""A row of a table, by column."""

Made = TypeVar("Made")


@dataclass(frozen=True)
class Figure:
    """A mean and its interval; None where the interval has no end."""

    mean: float
    low: float | None = None
    high: float | None = None

    def holds(self, value: float) -> bool:
        """Return whether a value lies within the interval, ends included."""
        return self.low is not None and self.high is not None and self.low <= value <= self.high


def figure_of(row: Row, name: str) -> Figure | None:
    """Give a column's value with its interval, whose columns are ``NAME_low``, or ``low``."""
    if row[name] is None:
        return None
    low, high = (row.get(f"{name}_{end}", row.get(end)) for end in ("low", "high"))
    return Figure(row[name], low, high)


def read_json(path: Path, make: Callable[[Any], Made], fault: str, way_out: str) -> Made:
    """Read a file, and make of its values what is needed; `ReportError` with `fault` and `way_out` if that fails."""
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


def estimate(interval: Interval) -> Figure:
    """Give a mean over objects; that of one object has no ends."""
    if math.isnan(interval.low):
        return Figure(interval.mean)
    return Figure(interval.mean, interval.low, interval.high)


def with_interval(figure: Figure, write: Callable[[float], str], unit: str = "") -> str:
    """Write a figure within a sentence, such as ``70.0 % (65.0 % to 75.0 %)``."""
    if figure.low is None or figure.high is None:
        return write(figure.mean) + unit
    return f"{write(figure.mean)}{unit} ({write(figure.low)} to {write(figure.high)})"


def share_above_interval(figure: Figure) -> Markup:
    """Write a share as `above_interval` does."""
    return above_interval(figure, percent)


def points_above_interval(figure: Figure) -> Markup:
    """Write a difference of shares as `above_interval` does."""
    return above_interval(figure, points)


def above_interval(figure: Figure, write: Callable[[float], str]) -> Markup:
    """Write a figure of a table's cell, with its interval in a line below."""
    mean = Markup('<data value="{}">{}</data>').format(figure.mean, write(figure.mean))
    if figure.low is None or figure.high is None:
        return mean
    ends = f"{write(figure.low)} to {write(figure.high)}"
    return mean + Markup('<span class="interval">{}</span>').format(ends)
