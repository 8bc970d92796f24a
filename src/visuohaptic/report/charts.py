"""Charts as numbers: where everything is drawn. The templates draw it.

Along a chart places are percentages of its width, so that text keeps its size on any screen.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from visuohaptic.report.comparison import Figure
from visuohaptic.report.wording import percent

LABEL_HEIGHT = 24
SERIES_HEIGHT = 18
ROW_GAP = 10
AXIS_HEIGHT = 28
TITLE_HEIGHT = 16
HALF = 0.5

STEPS = (1, 2, 5)
"""Ticks of each decade of a logarithmic axis."""


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
    left, right : float or None
        Ends of its interval along the chart, percent of the width.
    high, low : float or None
        Ends of its interval down the chart, pixels.
    kind : str
        What it is beside its series, such as ``published``; it gives its shape.
    name : str
        What stands beside it; may be empty.
    """

    series: int
    x: float
    y: float
    label: str
    left: float | None = None
    right: float | None = None
    high: float | None = None
    low: float | None = None
    kind: str = ""
    name: str = ""


@dataclass(frozen=True)
class Point:
    """One value of a series, in the units of its axes; `aside` moves it, percent of the width."""

    x: float
    y: float
    label: str
    x_ends: tuple[float, float] | None = None
    y_ends: tuple[float, float] | None = None
    kind: str = ""
    aside: float = 0.0
    name: str = ""


@dataclass(frozen=True)
class PointChart:
    """Series of points over two axes.

    Attributes
    ----------
    height : int
        Pixels, the axis across included.
    bottom : int
        Where the axis across stands, pixels.
    x_ticks, y_ticks : tuple of (float, str)
        Places and texts.
    lines : tuple of (int, float, float, float, float)
        Series, x1, y1, x2 and y2.
    marks : tuple of Mark
        Those that stand on top come last.
    """

    height: int
    bottom: int
    x_ticks: tuple[tuple[float, str], ...]
    y_ticks: tuple[tuple[float, str], ...]
    lines: tuple[tuple[int, float, float, float, float], ...]
    marks: tuple[Mark, ...]


class LogAxis:
    """A logarithmic axis whose ends are ticks; of its values, those above 0 count."""

    def __init__(self, values: Sequence[float]) -> None:
        positive = [value for value in values if value > 0]
        self.low = _step_below(min(positive))
        self.high = _step_above(max(positive))

    def share(self, value: float) -> float:
        """Give a value's place, 0 to 1."""
        place = math.log(value / self.low) / math.log(self.high / self.low)
        return min(max(place, 0.0), 1.0)

    def ticks(self) -> list[float]:
        """Give the ticks, both ends among them."""
        first, last = (math.floor(math.log10(end)) for end in (self.low, self.high))
        steps = [step * 10.0**power for power in range(first, last + 1) for step in STEPS]
        return [step for step in steps if self.low * 0.999 <= step <= self.high * 1.001]


Place = Callable[[float], float]


def place_points(
    series: Iterable[tuple[int, Sequence[Point]]], x_of: Place, y_of: Place, top: str = ""
) -> tuple[tuple[Mark, ...], tuple[tuple[int, float, float, float, float], ...]]:
    """Place series of points, each joined by lines in its order.

    Parameters
    ----------
    series : iterable of (int, sequence of Point)
        Number of a series, and points of it in the order in which they are joined.
    x_of, y_of : callable
        Place of a value, in percent of the width and in pixels.
    top : str
        Marks of this kind are drawn last.

    Returns
    -------
    marks : tuple of Mark
        A mark a point.
    lines : tuple
        As in `PointChart`.
    """
    marks: list[Mark] = []
    lines = []
    for number, points in series:
        placed = [_mark(number, point, x_of, y_of) for point in points]
        marks += placed
        lines += [
            (number, first.x, first.y, second.x, second.y)
            for first, second in itertools.pairwise(placed)
        ]
    return tuple(sorted(marks, key=lambda mark: mark.kind == top)), tuple(lines)


@dataclass(frozen=True)
class IntervalChart:
    """Marks with intervals, a row each, over an axis up to 100 %.

    It begins at 0, or at half where all figures and intervals lie above it.
    """

    height: int
    rows: tuple[tuple[str, int], ...]
    ticks: tuple[tuple[float, str], ...]
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

    A row has a label, and its figures and published values by series; the series stand below each
    other. `reference` is a share to draw a line at, such as chance.
    """
    start = _start(rows)

    def x_of(share: float) -> float:
        return round(100 * (share - start) / (1 - start), 2)

    marks: list[Mark] = []
    labels: list[tuple[str, int]] = []
    top = 0
    for label, figures, published in rows:
        labels.append((label, top + LABEL_HEIGHT - 8))
        for place, name in enumerate(series):
            y = top + LABEL_HEIGHT + (place + 0.5) * SERIES_HEIGHT
            if name in figures:
                marks.append(_interval_mark(place, figures[name], y, x_of))
            if name in published:
                value = published[name]
                label_of_value = f"published: {percent(value, 2)}"
                marks.append(Mark(place, x_of(value), y, label_of_value, kind="published"))
        top += LABEL_HEIGHT + len(series) * SERIES_HEIGHT + ROW_GAP
    return IntervalChart(
        height=top + AXIS_HEIGHT + TITLE_HEIGHT,
        rows=tuple(labels),
        ticks=tuple(
            (25 * step, f"{100 * start + 25 * (1 - start) * step:g} %") for step in range(5)
        ),
        marks=tuple(marks),
        reference=None if reference is None or reference < start else x_of(reference),
        baseline=top,
        series=len(series),
    )


@dataclass(frozen=True)
class ShareRow:
    """A row of a share chart: label, note, place down, end of its bar, and marks.

    Attributes
    ----------
    name, note : str
        What it is about, and what stands beside it.
    y : float
        Middle of the bar, pixels.
    end : float
        End of the bar, percent of the width.
    marks : tuple of (float, str, bool)
        Place, text, and whether it is beyond the limit.
    """

    name: str
    note: str
    y: float
    end: float
    marks: tuple[tuple[float, str, bool], ...]

    @property
    def exceeded(self) -> bool:
        """Whether a mark is beyond the limit."""
        return any(beyond for _, _, beyond in self.marks)


@dataclass(frozen=True)
class ShareChart:
    """Shares of a limit, a row for each group, over an axis from 0 to a little beyond the limit."""

    height: int
    bottom: int
    ticks: tuple[tuple[float, str], ...]
    rows: tuple[ShareRow, ...]


LARGEST_SHARE = 1.25


def place_share(share: float) -> float:
    """Give the place of a share of a limit, percent of the width; what is beyond stands at the right end."""
    return round(100 * min(share, LARGEST_SHARE) / LARGEST_SHARE, 2)


def share_chart(
    rows: Sequence[tuple[str, str, Sequence[tuple[float, str]]]],
) -> ShareChart:
    """Place shares of a limit.

    Parameters
    ----------
    rows : sequence of (str, str, sequence of (float, str))
        Name and note of each group, and its shares, each with a text; a share may be infinite.

    Returns
    -------
    ShareChart
        Where everything lies.
    """
    placed = []
    for number, (name, note, shares) in enumerate(rows):
        y = number * (LABEL_HEIGHT + SERIES_HEIGHT) + LABEL_HEIGHT + 0.5 * SERIES_HEIGHT
        marks = tuple((place_share(share), text, share > 1) for share, text in shares)
        end = max((x for x, _, _ in marks), default=0.0)
        placed.append(ShareRow(name, note, y, end, marks))
    bottom = len(placed) * (LABEL_HEIGHT + SERIES_HEIGHT) + ROW_GAP
    ticks = [(place_share(share), percent(share, 0)) for share in (0.0, 0.25, 0.5, 0.75)]
    return ShareChart(
        bottom + AXIS_HEIGHT + TITLE_HEIGHT,
        bottom,
        (*ticks, (place_share(1.0), "tolerance")),
        tuple(placed),
    )


def _start(rows: Sequence[tuple[str, Mapping[str, Figure], Mapping[str, float]]]) -> float:
    """Begin the axis at half where all that it shows lies above, since small distances count there."""
    values = [
        value
        for _, figures, published in rows
        for value in (
            *published.values(),
            *(figure.mean if figure.low is None else figure.low for figure in figures.values()),
        )
    ]
    return HALF if min(values, default=0.0) >= HALF else 0.0


def _interval_mark(series: int, figure: Figure, y: float, x_of: Place) -> Mark:
    label = percent(figure.mean)
    if figure.low is None or figure.high is None:
        return Mark(series, x_of(figure.mean), y, label)
    label += f", interval {percent(figure.low)} to {percent(figure.high)}"
    kind = ""
    if figure.is_limit:
        label, kind = f"{label} (exact binomial limit, as all objects agree)", "limit"
    ends = x_of(figure.low), x_of(figure.high)
    return Mark(series, x_of(figure.mean), y, label, *ends, kind=kind)


def _mark(series: int, point: Point, x_of: Place, y_of: Place) -> Mark:
    left, right = map(x_of, point.x_ends) if point.x_ends else (None, None)
    low, high = map(y_of, point.y_ends) if point.y_ends else (None, None)
    x = round(x_of(point.x) + point.aside, 2)
    return Mark(
        series, x, y_of(point.y), point.label, left, right, high, low, point.kind, point.name
    )


def _step_below(value: float) -> float:
    power = 10.0 ** math.floor(math.log10(value))
    return max(step * power for step in STEPS if step * power <= value * (1 + 1e-9))


def _step_above(value: float) -> float:
    power = 10.0 ** math.floor(math.log10(value))
    above = [step * power for step in (*STEPS, 10) if step * power >= value * (1 - 1e-9)]
    # An axis needs some length.
    return min(above) if min(above) > _step_below(value) else 2 * min(above)
