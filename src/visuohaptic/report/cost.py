"""What accuracy costs in time: charts of seconds against error rate, and what follows from them."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path

from visuohaptic.parameters import CostParameters, ExperimentParameters
from visuohaptic.report.charts import LogAxis, Mark, Point, PointChart, place_points
from visuohaptic.report.questions import Answer
from visuohaptic.report.wording import (
    counted,
    listed,
    percent,
    points,
    strategy_name,
    titled,
)
from visuohaptic.studies.cost.front import (
    Saving,
    all_touches,
    break_even,
    find_savings,
    first_step,
    front_rows,
    on_robot,
    read_costs,
    reference_row,
)
from visuohaptic.studies.cost.pairs import Row

HEIGHT = 420
"""Of the part with the logarithmic axis, pixels."""

LANE = 34
"""Height of a strip under it, for settings without an error and for those that failed."""


@dataclass(frozen=True)
class CostChart(PointChart):
    """A chart with strips under the axis, pixels; None where no setting stands there."""

    none_lane: float | None
    failed_lane: float | None


@dataclass(frozen=True)
class SettingGroup:
    """Settings that differ significantly neither in time nor in error: rows of `tables.COST`, at least one."""

    rows: tuple[Row, ...]

    @property
    def settings(self) -> list[tuple[str, str]]:
        """Each of their families, with its settings."""
        families = dict.fromkeys(row["family"] for row in self.rows)
        return [
            (
                strategy_name(family),
                "; ".join(str(row["setting"]) for row in self.rows if row["family"] == family),
            )
            for family in families
        ]

    @property
    def verdict(self) -> str:
        """Whether one of them is on the front."""
        if self.rows[0]["failed"]:
            return f"failed: {self.rows[0]['failed']}"
        if any(row["on_front"] for row in self.rows):
            return "on the front"
        return "dominated" if self.rows[0]["dominated"] else "not timed"

    @property
    def milliseconds(self) -> str:
        """Their median run times; with `quartiles` under them."""
        return self._range("seconds", "seconds", _milliseconds)

    @property
    def quartiles(self) -> str:
        """The lowest lower and the highest upper quartile."""
        return self._range("seconds_low", "seconds_high", _milliseconds)

    @property
    def error(self) -> str:
        """Their error rates in per cent; with `interval` under them."""
        return self._range("error", "error", lambda value: f"{100 * value:.2f}")

    @property
    def interval(self) -> str:
        """The lowest and the highest end of their intervals."""
        return self._range("error_low", "error_high", lambda value: f"{100 * value:.1f}")

    def part(self, name: str) -> str:
        """Give the median milliseconds of a part, such as ``look``."""
        column = f"seconds_{name}"
        return self._range(column, column, lambda value: f"{1000 * value:.1f}")

    def _range(self, low: str, high: str, write: Callable[[float], str]) -> str:
        if self.rows[0][low] is None:
            return "–"
        ends = min(row[low] for row in self.rows), max(row[high] for row in self.rows)
        written = dict.fromkeys(map(write, ends))
        return "\N{EN DASH}".join(written)


@dataclass(frozen=True)
class CostFigures:
    """The section's numbers, of one study.

    Attributes
    ----------
    families : tuple of str
        Names of the families, in the order of their colours.
    rows, front : sequence of mapping
        Rows of `tables.COST`: all, and those on the front, the quickest first.
    groups : tuple of SettingGroup
        All rows; those of one number in column `group` together.
    advice : list of str
        What follows from them, in sentences.
    recognitions : int
        Recognitions that each setting was timed on, at most.
    objects : int
        Objects that were tested, at most.
    reference : mapping or None
        The row of the run's own setting from one viewpoint.
    chart, robot : CostChart or None
        Computing time, and a robot's time, against error rate; None where nothing could be both
        run and timed.
    """

    families: tuple[str, ...]
    rows: Sequence[Row]
    front: Sequence[Row]
    groups: tuple[SettingGroup, ...]
    advice: list[str]
    recognitions: int
    objects: int
    reference: Row | None
    chart: CostChart | None
    robot: CostChart | None


def read_cost(path: str | Path | None, run: ExperimentParameters) -> CostFigures | None:
    """Read what accuracy costs from `tables.COST`; None where nothing was measured."""
    if path is None or not Path(path).is_file():
        return None
    return cost_figures(read_costs(path), run)


def cost_figures(rows: Sequence[Row], run: ExperimentParameters) -> CostFigures:
    """Give what accuracy costs.

    Parameters
    ----------
    rows : sequence of dict
        Rows of `tables.COST`.
    run : ExperimentParameters
        What was run; it has a robot's prices, and the confidence of intervals.

    Returns
    -------
    CostFigures
        The section's numbers.
    """
    families = tuple(dict.fromkeys(row["family"] for row in rows))
    robot = on_robot(rows, run.cost)
    return CostFigures(
        families,
        rows,
        front_rows(rows),
        _groups(rows),
        [*advise(rows, run), *advise_robot(rows, robot, run.cost)],
        max((row["recognitions"] or 0 for row in rows), default=0),
        max((row["objects"] or 0 for row in rows), default=0),
        reference_row(rows),
        cost_chart(rows, families),
        cost_chart(robot, families),
    )


def cost_verdict(figures: CostFigures) -> Answer | None:
    """Answer what accuracy costs in time: the quickest step and the most accurate setting."""
    first = first_step(figures.rows)
    if first is None:
        return None
    last = min(figures.front, key=lambda row: float(row["error"]))
    question = "What does accuracy cost in time?"
    if first["error"] <= last["error"]:
        return Answer(
            question,
            "no",
            _duration(first["seconds"]),
            f"a recognition at {percent(first['error'])} wrong: the quickest setting has the least "
            "error of all.",
            "cost",
        )
    return Answer(
        question,
        "depends",
        f"{_duration(first['seconds'])} to {_duration(last['seconds'])}",
        f"a recognition: {percent(first['error'])} wrong with the quickest setting, "
        f"{percent(last['error'])} with the most accurate.",
        "cost",
    )


@dataclass(frozen=True)
class TimePart:
    """A part of a recognition: median seconds of all its units, such as views."""

    name: str
    seconds: float
    units: int
    unit: str

    @property
    def each(self) -> str:
        """Its time for one unit, in words."""
        return f"{_duration(self.seconds / self.units)} a {self.unit}"


def time_parts(row: Row | None) -> list[TimePart]:
    """Say where the time of a recognition goes.

    Parameters
    ----------
    row : mapping or None
        A setting's row of `tables.COST`.

    Returns
    -------
    list of TimePart
        In the order of the work; empty where the setting was not timed.
    """
    if row is None or row["seconds"] is None:
        return []
    looking = row["seconds_render"] + row["seconds_attend"]
    views, touches = (row["looks"], "view"), (all_touches(row), "touch")
    parts = [
        TimePart("preparing the surface", row["seconds_look"] - looking, 1, "recognition"),
        TimePart("rendering", row["seconds_render"], *views),
        TimePart("attention: saliency and fixations", row["seconds_attend"], *views),
        TimePart("casting rays", row["seconds_cast"], *touches),
        TimePart("rest of touching", row["seconds_touch"] - row["seconds_cast"], *touches),
        TimePart("describing", row["seconds_describe"], *touches),
        TimePart("classification", row["seconds_name"], 1, "recognition"),
    ]
    # Medians of parts need not add up.
    return [replace(part, seconds=max(part.seconds, 0.0)) for part in parts if part.units]


def cue_sentences(rows: Sequence[Row]) -> list[str]:
    """Say what positions alone and imprints alone are worth, and the map of the paper's pipeline."""
    found = {(row["family"], row["setting"]): row for row in rows if row["error"] is not None}
    pose, skin = (found.get(("cues", name)) for name in ("pose alone", "skin alone"))
    sentences = []
    if pose and skin:
        sentences.append(
            f"“From touch alone” is mostly where the touches are, in an upright frame: with pipeline "
            f"best, positions and normals alone give {_correct(pose)}, imprints alone {_correct(skin)}."
        )
    without = found.get(("paper", "without the map"))
    if without:
        sentences.append(f"Without its map the paper's pipeline gives {_correct(without)}.")
    return sentences


def advise(rows: Sequence[Row], run: ExperimentParameters) -> list[str]:
    """Say which settings are worth their time, and how sure that is.

    Parameters
    ----------
    rows : sequence of mapping
        Rows of `tables.COST`.
    run : ExperimentParameters
        What was run.

    Returns
    -------
    list of str
        Sentences: the steps, then what each smaller setting saves and loses. The first names no
        seconds, and no setting by an order that is not significant.
    """
    first = first_step(rows)
    if first is None:
        return ["No setting could be both run and timed."]
    confidence = f"{100 * run.recognition.intervals.confidence:g} %"
    others = sum(row["as_quick"] for row in rows) - 1
    further = [row for row in rows if row["step"] and row is not first]
    further.sort(key=lambda row: -float(row["error"]))  # the order in which they were found
    alike = (
        f"; {counted(others, 'other setting')} {'is' if others == 1 else 'are'} not significantly slower than the quickest either"
        if others
        else ""
    )
    best = f"{_named(first)}: {percent(first['error'])} wrong ({_interval(first)})"
    told = [
        f"Of the settings that are not significantly slower than the quickest, the most accurate is {best}.",
        f"It takes {_duration(first['seconds'])}{alike}.",
    ]
    if further:
        told.append(
            f"Each of these is significantly slower and more accurate than the one before, at {confidence} "
            f"confidence: {'; '.join(f'{_named(row)}, {_figures(row)}' for row in further)}."
        )
    last = (first, *further)[-1]
    rest = [row for row in front_rows(rows) if row["seconds"] > last["seconds"]]
    if rest:
        told.append(
            f"With {counted(last['objects'], 'object')}, of {counted(len(rest), 'further setting')} of "
            "the front none is both significantly slower and significantly more accurate than "
            f"{_named(last)}."
        )
    return told + [_saving_sentence(saving, confidence) for saving in find_savings(rows)]


def advise_robot(rows: Sequence[Row], robot: Sequence[Row], cost: CostParameters) -> list[str]:
    """Say which strategy is ahead by computing time and by a robot's time, and from which price on.

    Parameters
    ----------
    rows, robot : sequence of mapping
        Rows of `tables.COST` with computing time and with a robot's time.
    cost : CostParameters
        The prices.

    Returns
    -------
    list of str
        Sentences; none where only one kind of strategy was measured.
    """
    found = break_even(rows)
    if found is None or not any(row["looks"] for row in rows):
        return []
    priced = f"{cost.touch_seconds:g} s for a touch and {cost.look_seconds:g} s for a look"
    told = [
        f"By {clock}, the quickest is {_leads(front_rows(table))}."
        for clock, table in (
            ("computing time", rows),
            (f"the time of a robot that takes {priced}", robot),
        )
    ]
    reached = (
        f"Without a look the error rate falls to {percent(found.error)} at best, with "
        f"{counted(all_touches(found.blind), 'touch')}"
    )
    price = found.touches_a_look
    if found.looking is None or price is None:
        return [*told, f"{reached}; no setting that looks is as accurate."]
    touches = counted(all_touches(found.looking), "touch")
    reached += f"; {touches} and {counted(found.looking['looks'], 'look')} reach the same or better"
    if price <= 0:
        return [*told, f"{reached}, so here looking saves no touch."]
    limit = f"{price:.2g} touches (here {cost.look_seconds:g} s, and {price * cost.touch_seconds:.3g} s)"
    return [*told, f"{reached}, so looking pays as long as a look takes less time than {limit}."]


def cost_chart(
    rows: Sequence[Row], families: Sequence[str], height: int = HEIGHT
) -> CostChart | None:
    """Place settings in a chart with two logarithmic axes.

    A logarithm has no place for an error rate of 0: such settings stand in a strip under
    the axis, with the upper end of their interval where it belongs.

    Parameters
    ----------
    rows : sequence of mapping
        Rows of `tables.COST`.
    families : sequence of str
        The families in the order of their colours.
    height : int
        Of the part with the logarithmic axis, pixels.

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
    bottom = height + LANE * (flawless + bool(failed))
    none_lane = height + LANE / 2 if flawless else None
    failed_lane = bottom - LANE / 2 if failed else None

    def x_of(seconds: float) -> float:
        return round(100 * across.share(seconds), 2)

    def y_of(error: float) -> float:
        if error <= 0:
            return none_lane or height
        return round(height * (1 - down.share(error)), 1)

    lines_of = [
        (number, [_point(row, down.low) for row in line])
        for number, family in enumerate(families)
        for line in _lines([row for row in placed if row["family"] == family])
    ]
    marks, lines = place_points(lines_of, x_of, y_of, top="front")
    failures = tuple(
        Mark(
            families.index(row["family"]),
            round(100 * (place + 0.5) / len(failed), 2),
            failed_lane or 0.0,
            f"{strategy_name(row['family'])}, {row['setting']}: failed. {row['failed']}",
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


def _groups(rows: Sequence[Row]) -> tuple[SettingGroup, ...]:
    found: dict[int, list[Row]] = {}
    for row in rows:
        found.setdefault(row["group"], []).append(row)
    return tuple(SettingGroup(tuple(group)) for group in found.values())


def _lines(rows: Sequence[Row]) -> list[list[Row]]:
    """Cut a family's settings where touches and viewpoints change both: a line is about one thing."""
    lines: list[list[Row]] = []
    for row in sorted(rows, key=lambda row: int(row["place"])):
        before = lines[-1][-1] if lines else row
        changed = sum(row[name] != before[name] for name in ("touches", "viewpoints"))
        if changed > 1 or not lines:
            lines.append([])
        lines[-1].append(row)
    return lines


def _label(row: Row) -> str:
    kind = "on the front" if row["on_front"] else "dominated"
    return (
        f"{strategy_name(row['family'])}, {row['setting']}: {_duration(row['seconds'], 3)} (quartiles "
        f"{_duration(row['seconds_low'], 3)} to {_duration(row['seconds_high'], 3)}), "
        f"{percent(row['error'], 2)} wrong (interval {percent(row['error_low'], 2)} to "
        f"{percent(row['error_high'], 2)}), {kind}"
    )


def _saving_sentence(saving: Saving, confidence: str) -> str:
    row = saving.row
    said = f"{titled(_named(row))} ({_changes(row)}) saves {percent(saving.saved, 0)} of the time"
    ends = f"{points(row['lost_low'])} to {points(row['lost_high'])}"
    if saving.verdict == "free":
        return f"{said} and costs less than 1 point of accuracy with {confidence} confidence."
    if saving.verdict == "open":
        return (
            f"{said}; its accuracy can't be told apart from the run's own with "
            f"{counted(row['objects'], 'object')} ({ends} points of error)."
        )
    return f"{said} and costs {points(row['lost'])} points of error ({ends})."


def _changes(row: Row) -> str:
    changes = json.loads(row["changes"])
    return listed([f"{name} {_short(value)}" for name, value in changes.items()])


def _milliseconds(seconds: float) -> str:
    return f"{1000 * seconds:.0f}"


def _short(value: object) -> str:
    if isinstance(value, dict):
        return listed([name for name, weight in value.items() if weight])
    return listed(value) if isinstance(value, list) else str(value)


def _leads(front: Sequence[Row]) -> str:
    """Say which strategy is the quickest down to which error rate."""
    groups = [list(group) for _, group in groupby(front, key=lambda row: row["strategy"])]
    return ", then ".join(
        f"{strategy_name(group[-1]['strategy'])} down to {percent(group[-1]['error'])} wrong "
        f"({_interval(group[-1])})"
        for group in groups
    )


def _figures(row: Row) -> str:
    return f"{_duration(row['seconds'])}, {percent(row['error'])} wrong ({_interval(row)})"


def _named(row: Row) -> str:
    return f"{strategy_name(row['family'])}, {row['setting']}"


def _correct(row: Row) -> str:
    ends = f"{percent(1 - row['error_high'])} to {percent(1 - row['error_low'])}"
    return f"{percent(1 - row['error'])} ({ends})"


def _interval(row: Row) -> str:
    return f"{percent(row['error_low'])} to {percent(row['error_high'])}"


def _duration(seconds: float, digits: int = 2) -> str:
    if seconds >= 1:
        return f"{seconds:.0f} s" if seconds >= 99.5 else f"{seconds:.{digits}g} s"
    return f"{1000 * seconds:.{digits}g} ms" if seconds < 0.0995 else f"{1000 * seconds:.0f} ms"


def _share(value: float) -> str:
    return f"{100 * value:g} %"
