"""Charts as numbers: where everything is drawn. The templates draw it.

Along a chart places are percentages of its width, so that text keeps its size on any screen.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from visuohaptic.report.comparison import Figure
from visuohaptic.report.wording import percent

LABEL_HEIGHT = 24
SERIES_HEIGHT = 18
ROW_GAP = 10
AXIS_HEIGHT = 28


@dataclass(frozen=True)
class Mark:
    """One mark of a chart.

    Attributes
    ----------
    series : int
        Place of its series, which gives its shape and colour.
    x : float
        Its place along the chart, percent of the width.
    y : float
        Its place down the chart, pixels.
    label : str
        What it says when pointed at.
    low, high : float or None
        Ends of its interval, percent of the width.
    published : bool
        Whether it is a published value, drawn hollow.
    """

    series: int
    x: float
    y: float
    label: str
    low: float | None = None
    high: float | None = None
    published: bool = False


@dataclass(frozen=True)
class IntervalChart:
    """Marks with intervals, a row each, over an axis from 0 to 100 %."""

    height: int
    rows: tuple[tuple[str, int], ...]
    ticks: tuple[int, ...]
    marks: tuple[Mark, ...]
    reference: float | None
    baseline: int
    series: int


def interval_chart(
    rows: Sequence[tuple[str, Mapping[str, Figure], Mapping[str, float]]],
    series: Sequence[str],
    reference: float | None,
) -> IntervalChart:
    """Place the marks of an interval chart.

    Parameters
    ----------
    rows : sequence of (str, mapping, mapping)
        Label of each row, its figures and its published values, by series.
    series : sequence of str
        Names of the series, in the order in which they stand below each other.
    reference : float or None
        A share to draw a line at, such as chance.

    Returns
    -------
    IntervalChart
        Where everything lies.
    """
    marks: list[Mark] = []
    labels: list[tuple[str, int]] = []
    top = 0
    for label, figures, published in rows:
        labels.append((label, top + LABEL_HEIGHT - 8))
        for place, name in enumerate(series):
            y = top + LABEL_HEIGHT + (place + 0.5) * SERIES_HEIGHT
            if name in figures:
                marks.append(_interval_mark(place, figures[name], y))
            if name in published:
                value = published[name]
                label_of_value = f"published: {percent(value, 2)}"
                marks.append(Mark(place, _x(value), y, label_of_value, published=True))
        top += LABEL_HEIGHT + len(series) * SERIES_HEIGHT + ROW_GAP
    return IntervalChart(
        height=top + AXIS_HEIGHT,
        rows=tuple(labels),
        ticks=(0, 25, 50, 75, 100),
        marks=tuple(marks),
        reference=None if reference is None else _x(reference),
        baseline=top,
        series=len(series),
    )


def _interval_mark(series: int, figure: Figure, y: float) -> Mark:
    label = percent(figure.mean)
    if figure.low is None or figure.high is None:
        return Mark(series, _x(figure.mean), y, label)
    label += f", interval {percent(figure.low)} to {percent(figure.high)}"
    return Mark(series, _x(figure.mean), y, label, _x(figure.low), _x(figure.high))


def _x(share: float) -> float:
    return round(100 * share, 2)
