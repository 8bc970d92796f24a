"""The charts of the report, each a function of the table that it shows.

In a notebook, ``figures.cost(pq.read_table("results/frontier.parquet"))`` shows the page's chart.
A table is a `pyarrow.Table` or its rows; what may be missing in it is None.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter
from typing import Any, Literal, TypeAlias

import pyarrow as pa
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from visuohaptic.base.errors import ReportError
from visuohaptic.report.comparison import read_tables
from visuohaptic.report.cost import reference_row, time_parts, timed
from visuohaptic.report.drawing import COLOURS, look, new_chart, style
from visuohaptic.report.estimates import Figure as Estimate
from visuohaptic.report.estimates import figure_of
from visuohaptic.report.stability import stability_figures
from visuohaptic.report.wording import (
    duration,
    percent,
    strategy_name,
    strategy_place,
    titled,
)

Rows: TypeAlias = pa.Table | Sequence[Mapping[str, Any]]
Write: TypeAlias = Callable[[float, float], str] | str

Marked: TypeAlias = Literal["on_front", "step"]

MARKED: Mapping[Marked, str] = {
    "on_front": "filled: no other is quicker and better",
    "step": "filled: worth its time",
}
"""Which settings a chart of costs fills, by their column of `tables.COST`."""

LARGEST_SHARE = 1.25
"""Where errors beyond their tolerance end, as a share of it."""

_HALF = 0.5
_ROW, _GAP, _AROUND = 12.0, 11.0, 44.0  # units: of a series, between rows, and of axis and name
_LEAST_ROWS = 64.0  # units, so that the name of the axis has room
_LEGEND_LINE = 15.0
_MOST_TICKS = 5


@dataclass(frozen=True)
class Series:
    """Estimates of one kind, one a row; `place` gives colour and mark, `ground` fills it, if not its colour."""

    label: str
    place: int
    estimates: Sequence[Estimate | None]
    ground: str | None = None


@style()
def comparison(metrics: Mapping[str, Any], pipeline: str = "paper") -> Figure:
    """Draw each classifier's accuracy in ``reports/metrics.json`` by strategy, here and as published, with chance."""
    (table,) = (one for one in read_tables(metrics) if one.name == pipeline)
    here = {name: [row.accuracy.get(name) for row in table.rows] for name in table.strategies}
    published = {
        name: [Estimate(row.published[name]) if row.published else None for row in table.rows]
        for name in table.strategies
        if any(name in row.published for row in table.rows)
    }
    series = _by_strategy(here) + [
        Series(f"{strategy_name(name)}, published", strategy_place(name), values, COLOURS["paper"])
        for name, values in published.items()
    ]
    names = [titled(row.name) for row in table.rows]
    chance = 1 / len(table.headline.class_accuracy[table.leading])
    return _draw_intervals(names, "classifier", series, chance=chance)


@style()
def conditions(table: Rows, chance: float | None = None) -> Figure:
    """Draw the accuracy under each condition of a study, by strategy.

    The rows are those of `tables.STUDY_FIGURES` of one pipeline and classifier; a further column
    ``words`` names the conditions.
    """
    rows = [row for row in _rows(table) if row["accuracy"] is not None]
    words = {row["condition"]: row.get("words", row["condition"]) for row in rows}
    found = {(row["strategy"], row["condition"]): figure_of(row, "accuracy") for row in rows}
    strategies = sorted({row["strategy"] for row in rows}, key=strategy_place)
    series = _by_strategy({one: [found.get((one, name)) for name in words] for one in strategies})
    return _draw_intervals(list(words.values()), "condition", series, chance=chance)


@style()
@style()
def cost(
    table: Rows,
    across: str = "computing time of a recognition",
    marked: Marked = "on_front",
    height: float = 250,
) -> Figure:
    """Draw the error rate of each setting against its seconds, both on logarithmic axes: rows of `tables.COST`.

    Settings that failed or were not timed are left out; `ReportError` if none is left. Lines join settings of which
    one thing changes; an error rate of 0 lies below the first tick; `across` says what the seconds are. Settings
    whose column `marked` is true are filled and named. `height` is that of the axes, in units of the chart.
    """
    rows = timed(_rows(table))
    if not rows:
        raise ReportError("No setting was both run and timed, so there is nothing to draw.")
    families = list(dict.fromkeys(row["family"] for row in rows))
    chart, axes = new_chart(height + _legend_height([*families, MARKED[marked]]))
    errors = log_ticks([row[name] for row in rows for name in ("error", "error_high")])
    axes.set_xscale("log")
    axes.set_yscale("symlog", linthresh=errors[0], linscale=0.3)
    for number, family in enumerate(families):
        colour, mark = look(number)
        drawn: dict[str, Any] = {"color": colour, "marker": mark, "mfc": COLOURS["paper"]}
        for line in trends([row for row in rows if row["family"] == family]):
            places = [row["seconds"] for row in line], [row["error"] for row in line]
            axes.plot(*places, markersize=4.5, linewidth=1, **drawn)
        axes.plot([], [], label=strategy_name(family), **drawn)
    _draw_front(axes, [row for row in rows if row[marked]], families)
    if not all(row[marked] for row in rows):
        filled: dict[str, Any] = {"linestyle": "", "marker": "o", "color": COLOURS["quiet"]}
        axes.plot([], [], label=MARKED[marked], **filled)
    seconds = log_ticks([row[name] for row in rows for name in ("seconds_low", "seconds_high")])
    flawless = any(row["error"] == 0 for row in rows)
    shown = [0.0, *errors] if flawless else errors
    axes.set_xticks(seconds, [duration(tick) for tick in seconds])
    axes.set_yticks(shown, [f"{100 * tick:g} %" for tick in shown])
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_ticks([], minor=True)
    lowest = -0.3 * errors[0] if flawless else errors[0] / 1.25
    axes.set_ylim(lowest, 1.1 * max(max(row["error"], row["error_high"]) for row in rows))
    return finish(chart, across, "error rate")


@style()
def parts_of_time(table: Rows) -> Figure:
    """Draw where the time of a recognition by the run's own setting goes: rows of `tables.COST`."""
    parts = time_parts(reference_row([dict(row) for row in _rows(table)]))
    chart, axes = new_chart(_AROUND + 20 * len(parts))
    seconds = [part["seconds"] for part in parts]
    axes.barh([part["name"] for part in parts], seconds, height=0.6, color=look(0)[0])
    for row, part in enumerate(parts):
        place = part["seconds"], row
        axes.annotate(part["each"], place, (3, 0), textcoords="offset points", va="center")
    axes.invert_yaxis()
    axes.set_xlim(0, 2.2 * max(seconds))
    across = "median time in one recognition"
    axes.grid(visible=False)
    return finish(chart, across, "part", across_as=lambda tick, _: duration(tick))


@style()
def stability(table: pa.Table) -> Figure:
    """Draw the errors of each requirement in `tables.STABILITY` as shares of its tolerance, a line per object.

    Those beyond their tolerance stand at the right end.
    """
    requirements = stability_figures(table).requirements
    chart, axes = new_chart(_AROUND + 26 * len(requirements))
    for row, checks in enumerate(requirements.values()):
        shares = [min(check.share, LARGEST_SHARE) for check in checks]
        held = all(check.held for check in checks)
        colour = look(0)[0] if held else COLOURS["bad"]
        axes.barh(row, max(shares), height=0.4, color=colour, alpha=0.3)
        axes.vlines(shares, row - 0.3, row + 0.3, colors=colour, linewidth=1.5)
    axes.axvline(1, color=COLOURS["bad"], linestyle="--", linewidth=1.2)
    labels = [textwrap.fill(titled(name), 26) for name in requirements]
    axes.set_yticks(range(len(requirements)), labels)
    axes.invert_yaxis()
    axes.set_xlim(0, LARGEST_SHARE)
    axes.set_xticks([0, 0.5, 1], ["0 %", "50 %", "tolerance"])
    axes.grid(visible=False, axis="y")
    return finish(chart, "worst error, share of tolerance", "requirement")


@style()
def bands(deviations: Sequence[float]) -> Figure:
    """Draw the deviations of the sub-bands of an imprint's contourlet transform."""
    chart, axes = new_chart(105, width=150)
    axes.bar(range(1, len(deviations) + 1), deviations, color=look(0)[0])
    axes.set_xticks([1, len(deviations)])
    axes.locator_params(axis="y", nbins=3)
    return finish(chart, "sub-band", "deviation")


def trends(rows: Sequence[Mapping[str, Any]]) -> list[list[Mapping[str, Any]]]:
    """Cut a family's settings where touches and viewpoints change both, or neither: a line is a trend."""
    lines: list[list[Mapping[str, Any]]] = []
    for row in sorted(rows, key=itemgetter("place")):
        before = lines[-1][-1] if lines else row
        changed = sum(row[name] != before[name] for name in ("touches", "viewpoints"))
        if changed != 1 or not lines:
            lines.append([])
        lines[-1].append(row)
    return lines


def log_ticks(values: Sequence[float]) -> list[float]:
    """Give a few round ticks around the values above 0: as many steps a decade as there is room for."""
    positive = [value for value in values if value > 0]
    first, last = math.log10(min(positive)), math.log10(max(positive))
    for steps in ((1, 1.5, 2, 3, 4, 5, 7), (1, 2, 3, 5), (1, 2, 5), (1, 3), (1,)):
        powers = range(math.floor(first) - 1, math.ceil(last) + 1)
        ticks = [step * 10.0**power for power in powers for step in steps]
        inner = [tick for tick in ticks if first <= math.log10(tick) <= last]
        below = max(tick for tick in ticks if math.log10(tick) <= first + 1e-9)
        if len(inner) <= _MOST_TICKS:
            break
    return sorted({below, *inner})


def _by_strategy(found: Mapping[str, Sequence[Estimate | None]]) -> list[Series]:
    return [Series(strategy_name(name), strategy_place(name), row) for name, row in found.items()]


def _draw_intervals(
    names: Sequence[str],
    rows_are: str,
    series: Sequence[Series],
    *,
    chance: float | None = None,
) -> Figure:
    """Draw a row a name, in it the marks of all series below each other with their intervals."""
    shown = [one for part in series for one in part.estimates if one is not None]
    if not shown:
        raise ReportError("Nothing was measured, so there is nothing to draw.")
    places = list(dict.fromkeys(one.place for one in series))
    rows = max(len(names) * (_GAP + _ROW * len(places)), _LEAST_ROWS)
    legend = [*(one.label for one in series if one.label), "chance"]
    chart, axes = new_chart(_AROUND + rows + _legend_height(legend))
    step = _ROW / (_GAP + _ROW * len(places))
    for one in series:
        _draw_series(axes, one, step * (places.index(one.place) - (len(places) - 1) / 2))
    # Small distances count where all lies above half.
    lowest = min(one.mean if one.low is None else one.low for one in shown)
    start = _HALF if lowest >= _HALF else 0.0
    if chance is not None and chance >= start:
        axes.axvline(chance, color=COLOURS["ink"], linestyle="--", linewidth=1, label="chance")
    axes.set_xlim(start, 1.01)
    axes.set_yticks(range(len(names)), [textwrap.fill(name, 24) for name in names])
    axes.set_ylim(len(names) - 0.5, -0.5)
    begins = f" (axis from {whole_percent(start)})" if start else ""
    axes.grid(visible=False, axis="y")
    return finish(chart, f"correctly classified{begins}", rows_are, across_as=whole_percent)


def draw_lines(lines: Mapping[str, Any], height: float, *more: str) -> tuple[Figure, Axes]:
    """Begin a chart with a line a strategy, of places across and up; its legend also has `more`."""
    chart, axes = new_chart(height + _legend_height([*lines, *more]))
    for strategy, places in lines.items():
        colour, mark = look(strategy_place(strategy))
        name = strategy_name(strategy)
        axes.plot(*places, color=colour, marker=mark, markersize=4, label=name)
    return chart, axes


def _draw_series(axes: Axes, series: Series, offset: float) -> None:
    rows = [(row + offset, one) for row, one in enumerate(series.estimates) if one is not None]
    colour, mark = look(series.place)
    for y, one in rows:
        if one.low is not None and one.high is not None:
            axes.hlines(y, one.low, one.high, colors=colour)
    axes.plot(
        [one.mean for _, one in rows], [y for y, _ in rows], linestyle="", marker=mark, color=colour,
        mfc=series.ground or colour, label=series.label or None, clip_on=False,
    )  # fmt: skip


def _draw_front(axes: Axes, rows: Sequence[Mapping[str, Any]], families: Sequence[str]) -> None:
    """Draw the front's settings filled, with their quartiles, intervals and names."""
    for row in rows:
        seconds, error = row["seconds"], row["error"]
        colour, mark = look(families.index(row["family"]))
        thin: dict[str, Any] = {"colors": colour, "linewidth": 0.8, "alpha": 0.6}
        axes.hlines(error, row["seconds_low"], row["seconds_high"], **thin)
        axes.vlines(seconds, row["error_low"], row["error_high"], **thin)
        axes.plot(seconds, error, color=colour, marker=mark, markersize=7, zorder=3)
        name = str(row["setting"]).removesuffix(", 1 viewpoint")
        # The names of two families stand on different sides, as their settings may lie close to each other.
        offset = (5, 4) if families.index(row["family"]) else (6, -8)
        axes.annotate(
            name, (seconds, error), offset, textcoords="offset points", zorder=4,
            bbox={"facecolor": COLOURS["paper"], "edgecolor": "none", "alpha": 0.8, "pad": 0.3},
        )  # fmt: skip


def finish(
    chart: Figure, across: str, up: str, across_as: Write | None = None, up_as: Write | None = None
) -> Figure:
    """Name the axes and the series of a chart, which is then complete."""
    (axes,) = chart.axes
    axes.set(xlabel=across, ylabel=up)
    for axis, write in ((axes.xaxis, across_as), (axes.yaxis, up_as)):
        if write is not None:
            axis.set_major_formatter(write)
    handles, labels = axes.get_legend_handles_labels()
    if labels:
        chart.legend(
            handles, [textwrap.fill(label, 30) for label in labels], loc="outside lower left",
            ncols=_columns_of(labels), handletextpad=0.4, columnspacing=1.2, borderpad=0.2,
        )  # fmt: skip
    return chart


def _columns_of(labels: Sequence[str]) -> int:
    return 3 if max(map(len, labels), default=0) <= 14 else 2


def _legend_height(labels: Sequence[str]) -> float:
    return _LEGEND_LINE * math.ceil(len(labels) / _columns_of(labels))


def whole_percent(share: float, _place: float = 0) -> str:
    """Write a share on an axis without decimals."""
    return percent(share, 0)


def _rows(table: Rows) -> list[Mapping[str, Any]]:
    return table.to_pylist() if isinstance(table, pa.Table) else list(table)
