"""What accuracy costs in time: the chart of seconds against error rate, and the table behind it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from visuohaptic.report.charts import LogAxis, Mark, Point, PointChart, place_points
from visuohaptic.report.wording import percent, spaced
from visuohaptic.studies.cost.front import advise, front_rows, read_costs

HEIGHT = 420
"""Of the part with the logarithmic axis, pixels."""

LANE = 34
"""Height of a strip under it, for settings without an error and for those that failed."""

Row = Mapping[str, Any]


@dataclass(frozen=True)
class CostChart(PointChart):
    """A chart with strips under the axis, pixels; None where no setting stands there."""

    none_lane: float | None
    failed_lane: float | None


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
    across = LogAxis([row[name] for row in placed for name in ("seconds_low", "seconds_high")])
    down = LogAxis([row[name] for row in placed for name in ("error", "error_high")])
    bottom = HEIGHT + LANE * (flawless + bool(failed))
    none_lane = HEIGHT + LANE / 2 if flawless else None
    failed_lane = bottom - LANE / 2 if failed else None

    def x_of(seconds: float) -> float:
        return round(100 * across.share(seconds), 2)

    def y_of(error: float) -> float:
        if error <= 0:
            return none_lane or HEIGHT
        return round(HEIGHT * (1 - down.share(error)), 1)

    lines_of = [
        [_point(row, down.low) for row in sorted(placed, key=_along) if row["family"] == family]
        for family in families
    ]
    marks, lines = place_points(lines_of, x_of, y_of, top="front")
    failures = tuple(
        Mark(
            families.index(row["family"]),
            round(100 * (place + 0.5) / len(failed), 2),
            failed_lane or 0.0,
            f"{spaced(row['family'])}, {row['setting']}: failed. {row['failed']}",
            kind="failed",
        )
        for place, row in enumerate(failed)
    )
    return CostChart(
        height=bottom + 44,
        bottom=bottom,
        x_ticks=tuple((x_of(value), _duration(value)) for value in across.ticks()),
        y_ticks=tuple((y_of(value), _share(value)) for value in down.ticks()),
        lines=lines,
        marks=(*marks, *failures),
        none_lane=none_lane,
        failed_lane=failed_lane,
    )


def _point(row: Row, lowest: float) -> Point:
    low = max(row["error_low"], lowest if row["error"] > 0 else 0.0)
    return Point(
        row["seconds"],
        row["error"],
        _label(row),
        (row["seconds_low"], row["seconds_high"]),
        (low, row["error_high"]),
        "front" if row["on_front"] else "dominated",
    )


def _along(row: Row) -> int:
    return int(row["place"])


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
