"""Functions that write a value as a cell of a table, such as `percent`; templates name them as ``cells.percent``."""

from __future__ import annotations

from markupsafe import Markup

from visuohaptic.evaluation.intervals import Interval
from visuohaptic.report.estimates import (
    Estimate,
    Row,
    above_interval,
    estimate,
    estimate_of,
    points_above_interval,
    share_above_interval,
)
from visuohaptic.report.wording import duration, percent, probability, spaced, strategy_name, titled

NONE = "\N{EN DASH}"
"""The text of a cell without a value."""

RECOMPUTED = {
    "recognition": "only the recognition",
    "features": "descriptors",
    "touches": "touches",
    "views": "views, fixations and touches",
}
"""The first step that a condition computes again, in words."""

# Functions of `wording` that write cells as well.
__all__ = ["duration", "percent", "probability", "spaced", "strategy_name", "titled"]


def number(text: str) -> str:
    """Return a text that is written already; its column is aligned as numbers are."""
    return text


def grouped(count: int) -> str:
    """Return a count with commas between thousands."""
    return f"{count:,}"


def one_decimal(value: float) -> str:
    """Return a number with one decimal."""
    return f"{value:.1f}"


def two_decimals(value: float) -> str:
    """Return a number with two decimals."""
    return f"{value:.2f}"


def three_decimals(value: float) -> str:
    """Return a number with three decimals."""
    return f"{value:.3f}"


def seconds(value: float) -> str:
    """Return seconds with as many digits as needed, at most six."""
    return f"{value:g} s"


def whole_percent(share: float) -> str:
    """Return a share as a percentage without decimals."""
    return percent(share, 0)


def exact_percent(share: float) -> str:
    """Return a share as a percentage with two decimals."""
    return percent(share, 2)


def exact_probability(value: float) -> Markup:
    """Return a p value as `probability` does, with all digits for programs that read the page."""
    return Markup('<data value="{}">{}</data>').format(value, probability(value))


def code(text: str) -> Markup:
    """Return a text in the type of code."""
    return Markup("<code>{}</code>").format(text)


def titled_strategy(key: str) -> str:
    """Return the name of a strategy in words, with an upper-case first letter."""
    return titled(strategy_name(key))


def recomputed(step: str) -> str:
    """Return in words the first step that a condition computes again."""
    return RECOMPUTED[step]


def accuracy_or_error(row: Row) -> str:
    """Return the accuracy of a row of `tables.STUDY_FIGURES` with its interval, or why there is none."""
    accuracy = estimate_of(row, "accuracy")
    return f"failed: {row['error']}" if accuracy is None else share_above_interval(accuracy)


def percent_with_interval(value: Estimate | Interval | float) -> Markup:
    """Return a share in per cent, with its interval on a line below."""
    return share_above_interval(_figure(value))


def points_with_interval(value: Estimate | Interval | float) -> Markup:
    """Return a difference of shares in percentage points, with its interval on a line below."""
    return points_above_interval(_figure(value))


def duration_with_interval(value: Estimate | Interval | float) -> Markup:
    """Return seconds as `duration` does, with their interval on a line below."""
    return above_interval(_figure(value), duration)


def _figure(value: Estimate | Interval | float) -> Estimate:
    if isinstance(value, Interval):
        return estimate(value)
    return value if isinstance(value, Estimate) else Estimate(value)
