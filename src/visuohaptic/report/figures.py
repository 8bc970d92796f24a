"""The charts of the report, one function per chart.

In a notebook, ``figures.cost(pq.read_table("results/frontier.parquet"))`` shows the page's chart. A table is a
`pyarrow.Table` or a sequence of its rows; missing values are None.
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
from visuohaptic.evaluation.leads import LEADS, LeadName
from visuohaptic.report.comparison import PipelineTable
from visuohaptic.report.cost import reference_row, time_parts, timed
from visuohaptic.report.drawing import COLOURS, look, new_chart, style
from visuohaptic.report.estimates import Estimate, estimate_of
from visuohaptic.report.leads import Lead
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
"""Legends of filled marks in charts of costs, by the column of `tables.COST` that is true for these settings."""

LARGEST_SHARE = 1.25
"""Errors above this share of their tolerance are drawn at this share."""

LEGENDS: Mapping[LeadName, str] = {
    "seeing": "seeing: fixations minus random places in reach",
    "sight": "seeing: random places in sight minus in reach",
    "salience": "salience: fixations minus random places in sight",
}
"""Legends of leads."""

_HALF = 0.5
_ROW, _GAP, _AROUND = 12.0, 11.0, 44.0  # units: per series, between rows, and for axis and name
_LEAST_ROWS = 64.0  # units, so that the name of the axis has room
_LEGEND_LINE = 15.0
_MOST_TICKS = 5


@dataclass(frozen=True)
class Series:
    """Estimates that share a colour and a mark.

    Attributes
    ----------
    label : str
        The text of the legend; none if empty.
    place : int
        The index of colour and mark, as for `drawing.look`.
    estimates : sequence of Figure or None
        One estimate per row of the chart; None leaves the row empty.
    ground : str, optional
        The colour that fills the marks; by default the colour of the series.
    wider : sequence of Figure or None
        Estimates with wider intervals, which are drawn as thin lines; none by default.
    """

    label: str
    place: int
    estimates: Sequence[Estimate | None]
    ground: str | None = None
    wider: Sequence[Estimate | None] = ()


@style()
def comparison(table: PipelineTable) -> Figure:
    """Draw the accuracy of each classifier by strategy, in this run and as published, with a line at chance."""
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
    return draw_intervals(names, "classifier", series, chance=chance)


@style()
def leads(shown: Sequence[Lead]) -> Figure:
    """Draw leads, one row per condition and one mark per compared strategies, with a line at 0.

    Thick lines are intervals for new objects, thin lines for new classes. The order of the rows is the order in which
    conditions first appear in `shown`.
    """
    by_row: dict[str, dict[LeadName, Lead]] = {}
    for lead in shown:
        by_row.setdefault(lead.condition, {})[lead.name] = lead
    found = {name: [row.get(name) for row in by_row.values()] for name in _lead_names(shown)}
    series = [
        Series(
            LEGENDS[name],
            list(LEADS).index(name),
            [None if lead is None else lead.difference for lead in column],
            wider=[None if lead is None else of_new_classes(lead.difference) for lead in column],
        )
        for name, column in found.items()
    ]
    return draw_leads([titled(row) for row in by_row], "condition", series)


def of_new_classes(figure: Estimate) -> Estimate:
    """Return a figure with its interval of new classes in place of that of new objects."""
    return Estimate(figure.mean, figure.new_classes_low, figure.new_classes_high)


def _lead_names(shown: Sequence[Lead]) -> list[LeadName]:
    return [name for name in LEADS if any(lead.name == name for lead in shown)]


@style()
def draw_leads(rows: Sequence[str], rows_are: str, series: Sequence[Series]) -> Figure:
    """Draw one row per name with mark and intervals of each series, in percentage points."""
    if not series:
        raise ReportError("No lead was measured, so there is nothing to draw.")
    labels = [textwrap.fill(row, 30) for row in rows]
    lines = sum(max(len(series) * _ROW, 11.0 * (label.count("\n") + 1)) + _GAP for label in labels)
    chart, axes = new_chart(_AROUND + lines + _LEGEND_LINE * len(series))
    step = 0.8 / len(series)
    for place, one in enumerate(series):
        _draw_series(axes, one, step * (place - (len(series) - 1) / 2))
    axes.axvline(0, color=COLOURS["ink"], linewidth=1)
    axes.set_yticks(range(len(labels)), labels)
    axes.set_ylim(len(labels) - 0.5, -0.5)
    axes.grid(visible=False, axis="y")
    return label_axes(chart, "lead, percentage points", rows_are, xformat=as_points, columns=1)


@style()
def conditions(table: Rows, chance: float | None = None) -> Figure:
    """Draw the accuracy under each condition of a study, by strategy.

    `table` has rows of `tables.STUDY_FIGURES` of one pipeline and classifier. An optional column ``words`` names the
    conditions in words. `chance` is the share of correct guesses; a dashed line marks it.
    """
    rows = [row for row in _rows(table) if row["accuracy"] is not None]
    words = {row["condition"]: row.get("words", row["condition"]) for row in rows}
    accuracy = {(row["strategy"], row["condition"]): estimate_of(row, "accuracy") for row in rows}
    strategies = sorted({row["strategy"] for row in rows}, key=strategy_place)
    series = _by_strategy(
        {name: [accuracy.get((name, condition)) for condition in words] for name in strategies}
    )
    return draw_intervals(list(words.values()), "condition", series, chance=chance)


@style()
def cost(
    table: Rows,
    across: str = "computing time of a recognition",
    marked: Marked = "on_front",
    height: float = 250,
) -> Figure:
    """Draw the error rate of each setting against its seconds, both on logarithmic axes.

    Lines join settings that differ in one thing. An error rate of 0 lies below the first tick.

    Parameters
    ----------
    table : pyarrow.Table or rows
        Rows of `tables.COST`. Settings that failed or were not timed are left out.
    across : str
        The name of the axis of seconds.
    marked : {"on_front", "step"}
        The column that is true for settings with a filled mark and a name.
    height : float
        The height of the axes in units of the chart.

    Raises
    ------
    ReportError
        If no setting has both seconds and an error rate.
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
            points = [row["seconds"] for row in line], [row["error"] for row in line]
            axes.plot(*points, markersize=4.5, linewidth=1, **drawn)
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
    return label_axes(chart, across, "error rate")


@style()
def parts_of_time(table: Rows) -> Figure:
    """Draw the median time of each part of a recognition by the run's own setting.

    `table` has rows of `tables.COST`, among them the timed row of the run's own setting.
    """
    parts = time_parts(reference_row([dict(row) for row in _rows(table)]))
    chart, axes = new_chart(_AROUND + 20 * len(parts))
    seconds = [part["seconds"] for part in parts]
    axes.barh([part["name"] for part in parts], seconds, height=0.6, color=look(0)[0])
    for row, part in enumerate(parts):
        end_of_bar = part["seconds"], row
        axes.annotate(part["each"], end_of_bar, (3, 0), textcoords="offset points", va="center")
    axes.invert_yaxis()
    axes.set_xlim(0, 2.2 * max(seconds))
    across = "median time in one recognition"
    axes.grid(visible=False)
    return label_axes(chart, across, "part", xformat=lambda tick, _: duration(tick))


@style()
def stability(table: pa.Table) -> Figure:
    """Draw the errors of each requirement as shares of its tolerance, one line per object.

    `table` has rows of `tables.STABILITY`. Errors above `LARGEST_SHARE` are drawn at the right end.
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
    return label_axes(chart, "worst error, share of tolerance", "requirement")


@style()
def bands(numbers: Sequence[float], across: str = "sub-band", along: str = "deviation") -> Figure:
    """Draw the numbers that describe an imprint, one bar per number, with the labels of both axes."""
    chart, axes = new_chart(105, width=150)
    axes.bar(range(1, len(numbers) + 1), numbers, color=look(0)[0])
    axes.set_xticks([1, len(numbers)])
    axes.locator_params(axis="y", nbins=3)
    return label_axes(chart, across, along)


def trends(rows: Sequence[Mapping[str, Any]]) -> list[list[Mapping[str, Any]]]:
    """Split a family's settings into lines along which only touches or only viewpoints change from row to row.

    `rows` are rows of `tables.COST`; the lines follow column ``place``.
    """
    lines: list[list[Mapping[str, Any]]] = []
    for row in sorted(rows, key=itemgetter("place")):
        before = lines[-1][-1] if lines else row
        changed = sum(row[name] != before[name] for name in ("touches", "viewpoints"))
        if changed != 1 or not lines:
            lines.append([])
        lines[-1].append(row)
    return lines


def log_ticks(values: Sequence[float]) -> list[float]:
    """Return a few round ticks for a logarithmic axis, as many per decade as there is room for.

    `values` include at least one value above 0; other values are left out.
    """
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


def _by_strategy(estimates: Mapping[str, Sequence[Estimate | None]]) -> list[Series]:
    return [
        Series(strategy_name(name), strategy_place(name), row) for name, row in estimates.items()
    ]


@style()
def draw_intervals(
    names: Sequence[str],
    rows_are: str,
    series: Sequence[Series],
    *,
    chance: float | None = None,
) -> Figure:
    """Draw accuracies with one row per name, and with mark and interval of each series.

    `rows_are` names the axis of the rows, such as ``classifier``. A dashed line marks `chance`, the share of correct
    guesses. Raises `ReportError` without an estimate.
    """
    estimates = [estimate for row in series for estimate in row.estimates if estimate is not None]
    if not estimates:
        raise ReportError("Nothing was measured, so there is nothing to draw.")
    # Series of one strategy, such as here and published, share a line.
    lines = list(dict.fromkeys(row.place for row in series))
    rows = max(len(names) * (_GAP + _ROW * len(lines)), _LEAST_ROWS)
    legend = [*(row.label for row in series if row.label), "chance"]
    chart, axes = new_chart(_AROUND + rows + _legend_height(legend))
    step = _ROW / (_GAP + _ROW * len(lines))
    for row in series:
        _draw_series(axes, row, step * (lines.index(row.place) - (len(lines) - 1) / 2))
    # Above one half, differences are small; the axis then begins at one half, so that they can be seen.
    lowest = min(estimate.mean if estimate.low is None else estimate.low for estimate in estimates)
    start = _HALF if lowest >= _HALF else 0.0
    if chance is not None and chance >= start:
        axes.axvline(chance, color=COLOURS["ink"], linestyle="--", linewidth=1, label="chance")
    axes.set_xlim(start, 1.01)
    axes.set_yticks(range(len(names)), [textwrap.fill(name, 24) for name in names])
    axes.set_ylim(len(names) - 0.5, -0.5)
    begins = f" (axis from {whole_percent(start)})" if start else ""
    axes.grid(visible=False, axis="y")
    return label_axes(chart, f"correctly classified{begins}", rows_are, xformat=whole_percent)


def draw_lines(lines: Mapping[str, Any], height: float, *more: str) -> tuple[Figure, Axes]:
    """Return a new chart with one line per strategy.

    Parameters
    ----------
    lines : mapping of str to (sequence, sequence)
        The horizontal and the vertical values of each strategy's line.
    height : float
        The height of the axes in units of the chart.
    more : str
        Further labels, for which the legend gets room.
    """
    chart, axes = new_chart(height + _legend_height([*lines, *more]))
    for strategy, values in lines.items():
        colour, mark = look(strategy_place(strategy))
        name = strategy_name(strategy)
        axes.plot(*values, color=colour, marker=mark, markersize=4, label=name)
    return chart, axes


@style()
def draw_by_touches(touches: Sequence[int], series: Sequence[Series]) -> Figure:
    """Draw accuracies against the number of touches, one line per series with its intervals as a band.

    The estimates of a series belong to the numbers of `touches`, in their order.
    """
    chart, axes = new_chart(_AROUND + 200 + _LEGEND_LINE * len(series))
    for one in series:
        colour, mark = look(one.place)
        found = [
            (number, estimate)
            for number, estimate in zip(touches, one.estimates, strict=True)
            if estimate is not None
        ]
        numbers = [number for number, _ in found]
        means = [estimate.mean for _, estimate in found]
        axes.plot(numbers, means, color=colour, marker=mark, markersize=4.5, label=one.label)
        if all(estimate.low is not None for _, estimate in found):
            low, high = ([getattr(one, end) for _, one in found] for end in ("low", "high"))
            axes.fill_between(numbers, low, high, color=colour, alpha=0.12, linewidth=0)
    axes.set_xscale("log")
    axes.set_xticks(touches, [str(number) for number in touches])
    axes.set_xticks([], minor=True)
    axes.set_ylim(0, 1.01)
    return label_axes(chart, "touches", "correctly classified", yformat=whole_percent, columns=1)


def _draw_series(axes: Axes, series: Series, offset: float) -> None:
    rows = [
        (row + offset, estimate)
        for row, estimate in enumerate(series.estimates)
        if estimate is not None
    ]
    colour, mark = look(series.place)
    for row, estimate in enumerate(series.wider):
        if estimate is not None and estimate.low is not None and estimate.high is not None:
            axes.hlines(row + offset, estimate.low, estimate.high, colors=colour, linewidth=0.8)
    for y, estimate in rows:
        if estimate.low is not None and estimate.high is not None:
            axes.hlines(y, estimate.low, estimate.high, colors=colour)
    axes.plot(
        [estimate.mean for _, estimate in rows], [y for y, _ in rows], linestyle="", marker=mark,
        color=colour, mfc=series.ground or colour, label=series.label or None, clip_on=False,
    )  # fmt: skip


def _draw_front(axes: Axes, rows: Sequence[Mapping[str, Any]], families: Sequence[str]) -> None:
    """Draw settings with filled marks, quartiles of the time, intervals of the error rate, and names."""
    for row in rows:
        seconds, error = row["seconds"], row["error"]
        colour, mark = look(families.index(row["family"]))
        thin: dict[str, Any] = {"colors": colour, "linewidth": 0.8, "alpha": 0.6}
        axes.hlines(error, row["seconds_low"], row["seconds_high"], **thin)
        axes.vlines(seconds, row["error_low"], row["error_high"], **thin)
        axes.plot(seconds, error, color=colour, marker=mark, markersize=7, zorder=3)
        name = str(row["setting"]).removesuffix(", 1 viewpoint")
        # Settings of two families may lie close to each other, so their names are on different sides.
        offset = (5, 4) if families.index(row["family"]) else (6, -8)
        axes.annotate(
            name, (seconds, error), offset, textcoords="offset points", zorder=4,
            bbox={"facecolor": COLOURS["paper"], "edgecolor": "none", "alpha": 0.8, "pad": 0.3},
        )  # fmt: skip


def label_axes(
    chart: Figure,
    xlabel: str,
    ylabel: str,
    xformat: Write | None = None,
    yformat: Write | None = None,
    columns: int | None = None,
) -> Figure:
    """Name the axes of a chart, add its legend, and return the chart.

    `xformat` and `yformat` format the ticks. `columns` is the number of columns of the legend; by default the number follows
    from the labels.
    """
    (axes,) = chart.axes
    axes.set(xlabel=xlabel, ylabel=ylabel)
    for axis, write in ((axes.xaxis, xformat), (axes.yaxis, yformat)):
        if write is not None:
            axis.set_major_formatter(write)
    handles, labels = axes.get_legend_handles_labels()
    if labels:
        chart.legend(
            handles, [textwrap.fill(label, 30 if columns is None else 60) for label in labels],
            loc="outside lower left", ncols=columns or _columns_of(labels), handletextpad=0.4, columnspacing=1.2, borderpad=0.2,
        )  # fmt: skip
    return chart


def _columns_of(labels: Sequence[str]) -> int:
    return 3 if max(map(len, labels), default=0) <= 14 else 2


def _legend_height(labels: Sequence[str]) -> float:
    return _LEGEND_LINE * math.ceil(len(labels) / _columns_of(labels))


def whole_percent(share: float, _place: float = 0) -> str:
    """Return a share in per cent without decimals; a formatter of ticks, which ignores the tick's index."""
    return percent(share, 0)


def as_points(difference: float, _place: float = 0) -> str:
    """Return a difference of shares in percentage points, with the decimals that it has; a formatter of ticks."""
    value = 100 * difference
    return "0" if abs(value) < 1e-9 else f"{value:+.3g}".replace("-", "\N{MINUS SIGN}")


def _rows(table: Rows) -> list[Mapping[str, Any]]:
    return table.to_pylist() if isinstance(table, pa.Table) else list(table)
