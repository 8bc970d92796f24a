"""What accuracy costs in time: the chart of seconds against error rate, and the table behind it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from visuohaptic.report.wording import percent, spaced
from visuohaptic.studies.cost.front import advise, front_rows, read_costs

HEIGHT = 420
"""Of the part with the logarithmic axis, pixels."""

LANE = 34
"""Height of a strip under it, for settings without an error and for those that failed."""

STEPS = (1, 2, 5)

Row = Mapping[str, Any]


@dataclass(frozen=True)
class CostMark:
    """One setting in the chart.

    Attributes
    ----------
    family : int
        Place of its family, which gives its colour.
    kind : str
        ``front``, ``dominated`` or ``failed``.
    x : float
        Percent of the chart's width.
    y : float
        Pixels from the top.
    label : str
        What it says when pointed at.
    high, low : float or None
        Ends of the error rate's interval, pixels from the top.
    left, right : float or None
        Quartiles of the seconds, percent of the width.
    """

    family: int
    kind: str
    x: float
    y: float
    label: str
    high: float | None = None
    low: float | None = None
    left: float | None = None
    right: float | None = None


@dataclass(frozen=True)
class CostChart:
    """Where everything lies: lines are (family, x1, y1, x2, y2), ticks (place, text)."""

    height: int
    bottom: int
    none_lane: float | None
    failed_lane: float | None
    x_ticks: tuple[tuple[float, str], ...]
    y_ticks: tuple[tuple[float, str], ...]
    lines: tuple[tuple[int, float, float, float, float], ...]
    marks: tuple[CostMark, ...]


@dataclass(frozen=True)
class CostFigures:
    """The section's numbers.

    Attributes
    ----------
    families : tuple of str
        Names of the families, in the order of their colours.
    rows, front : sequence of mapping
        Rows of `tables.COST`: all, and those on the front, the quickest first.
    advice : str
        The plain sentence.
    recognitions : int
        Recognitions that each setting was timed on.
    chart : CostChart or None
        None where nothing could be both run and timed.
    """

    families: tuple[str, ...]
    rows: Sequence[Row]
    front: Sequence[Row]
    advice: str
    recognitions: int
    chart: CostChart | None


def cost_figures(path: str | Path | None) -> CostFigures | None:
    """Read what accuracy costs.

    Parameters
    ----------
    path : path or None
        `tables.COST`.

    Returns
    -------
    CostFigures or None
        None where nothing was measured.
    """
    if path is None or not Path(path).is_file():
        return None
    rows = read_costs(path)
    families = tuple(dict.fromkeys(row["family"] for row in rows))
    return CostFigures(
        families,
        rows,
        front_rows(rows),
        advise(rows),
        max((row["recognitions"] or 0 for row in rows), default=0),
        cost_chart(rows, families),
    )


def cost_chart(rows: Sequence[Row], families: Sequence[str]) -> CostChart | None:
    """Place settings in a chart with two logarithmic axes.

    A logarithm has no place for an error rate of 0: such settings stand in a strip under
    the axis, with the upper end of their interval where it belongs.

    Parameters
    ----------
    rows : sequence of mapping
        Rows of `tables.COST`.
    families : sequence of str
        The families in the order of their colours.

    Returns
    -------
    CostChart or None
        None where no row has both seconds and an error rate.
    """
    placed = [row for row in rows if row["failed"] is None and row["seconds"] is not None]
    if not placed:
        return None
    failed = [row for row in rows if row["failed"] is not None]
    flawless = any(row["error"] == 0 for row in placed)
    across = _Axis([row[name] for row in placed for name in ("seconds_low", "seconds_high")])
    down = _Axis([row[name] for row in placed for name in ("error", "error_high")])
    none_lane = HEIGHT + LANE / 2 if flawless else None
    failed_lane = HEIGHT + LANE * (flawless + 0.5) if failed else None

    def x_of(seconds: float) -> float:
        return round(100 * across.share(seconds), 2)

    def y_of(error: float) -> float:
        if error <= 0:
            return none_lane or HEIGHT
        return round(HEIGHT * (1 - down.share(error)), 1)

    marks = [
        CostMark(
            families.index(row["family"]),
            "front" if row["on_front"] else "dominated",
            x_of(row["seconds"]),
            y_of(row["error"]),
            _label(row),
            high=y_of(row["error_high"]),
            low=y_of(max(row["error_low"], down.low if row["error"] > 0 else 0.0)),
            left=x_of(row["seconds_low"]),
            right=x_of(row["seconds_high"]),
        )
        # The front is drawn last, on top.
        for row in sorted(placed, key=lambda row: row["on_front"])
    ]
    for place, row in enumerate(failed):
        x = round(100 * (place + 0.5) / len(failed), 2)
        label = f"{spaced(row['family'])}, {row['setting']}: failed. {row['failed']}"
        marks.append(
            CostMark(families.index(row["family"]), "failed", x, failed_lane or 0.0, label)
        )
    return CostChart(
        height=HEIGHT + LANE * (flawless + bool(failed)) + 44,
        bottom=HEIGHT + LANE * (flawless + bool(failed)),
        none_lane=none_lane,
        failed_lane=failed_lane,
        x_ticks=tuple((x_of(value), _duration(value)) for value in across.ticks()),
        y_ticks=tuple((y_of(value), _share(value)) for value in down.ticks()),
        lines=tuple(_lines(placed, families, x_of, y_of)),
        marks=tuple(marks),
    )


class _Axis:
    """A logarithmic axis whose ends are ticks."""

    def __init__(self, values: Sequence[float]) -> None:
        positive = [value for value in values if value > 0]
        self.low = _step_below(min(positive))
        self.high = _step_above(max(positive))

    def share(self, value: float) -> float:
        place = math.log(value / self.low) / math.log(self.high / self.low)
        return min(max(place, 0.0), 1.0)

    def ticks(self) -> list[float]:
        first, last = (math.floor(math.log10(end)) for end in (self.low, self.high))
        steps = [step * 10.0**power for power in range(first, last + 1) for step in STEPS]
        return [step for step in steps if self.low * 0.999 <= step <= self.high * 1.001]


def _step_below(value: float) -> float:
    power = 10.0 ** math.floor(math.log10(value))
    return max(step * power for step in STEPS if step * power <= value * (1 + 1e-9))


def _step_above(value: float) -> float:
    power = 10.0 ** math.floor(math.log10(value))
    above = [step * power for step in (*STEPS, 10) if step * power >= value * (1 - 1e-9)]
    # An axis needs some length.
    return min(above) if min(above) > _step_below(value) else 2 * min(above)


def _lines(
    rows: Sequence[Row], families: Sequence[str], x_of: Any, y_of: Any
) -> Iterator[tuple[int, float, float, float, float]]:
    for place, family in enumerate(families):
        line = sorted(
            (row for row in rows if row["family"] == family), key=lambda row: row["place"]
        )
        for first, second in itertools.pairwise(line):
            start, end = ((x_of(row["seconds"]), y_of(row["error"])) for row in (first, second))
            yield (place, *start, *end)


def _label(row: Row) -> str:
    kind = "on the front" if row["on_front"] else "dominated"
    return (
        f"{spaced(row['family'])}, {row['setting']}: {_duration(row['seconds'], 3)} (quartiles "
        f"{_duration(row['seconds_low'], 3)} to {_duration(row['seconds_high'], 3)}), "
        f"{percent(row['error'], 2)} wrong (interval {percent(row['error_low'], 2)} to "
        f"{percent(row['error_high'], 2)}), {kind}"
    )


def _duration(seconds: float, digits: int = 2) -> str:
    if seconds >= 1:
        return f"{seconds:.{digits}g} s"
    return f"{1000 * seconds:.{digits}g} ms" if seconds < 0.0995 else f"{1000 * seconds:.0f} ms"


def _share(value: float) -> str:
    return f"{100 * value:g} %"
