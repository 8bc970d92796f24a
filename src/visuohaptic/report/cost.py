"""What accuracy costs in time: steps worth their time, and what smaller settings save."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from visuohaptic.parameters import CostParameters, ExperimentParameters
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
    read_costs,
    reference_row,
)
from visuohaptic.studies.cost.pairs import Row


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
        ends = self._range("error_low", "error_high", lambda value: f"{100 * value:.1f}")
        return f"{ends}†" if any(row["error"] in (0.0, 1.0) for row in self.rows) else ends

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
    steps : sequence of mapping
        Those that are worth their time, as `step_rows` gives them.
    price : str
        When looking pays on a robot; may be empty.
    savings : list of str
        What smaller settings save and lose.
    recognitions : int
        Recognitions that each setting was timed on, at most.
    objects : int
        Objects that were tested, at most.
    reference : mapping or None
        The row of the run's own setting from one viewpoint.
    """

    families: tuple[str, ...]
    rows: Sequence[Row]
    front: Sequence[Row]
    groups: tuple[SettingGroup, ...]
    steps: Sequence[Row]
    price: str
    savings: list[str]
    recognitions: int
    objects: int
    reference: Row | None


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
    return CostFigures(
        families,
        rows,
        front_rows(rows),
        _groups(rows),
        step_rows(rows),
        robot_sentence(rows, run.cost),
        saving_sentences(rows, run),
        max((row["recognitions"] or 0 for row in rows), default=0),
        max((row["objects"] or 0 for row in rows), default=0),
        reference_row(rows),
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
            _with_quartiles(first),
            f"of computing, error rate {percent(first['error'])} ({_named(first)}): the quickest "
            "setting has the lowest error rate, too.",
            "cost",
        )
    return Answer(
        question,
        "depends",
        _with_quartiles(first),
        f"of computing for an error rate of {percent(first['error'])} ({_named(first)}); the lowest, "
        f"{percent(last['error'])}, takes {duration(last['seconds'])}.",
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
        return f"{duration(self.seconds / self.units)} a {self.unit}"


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
        tells = (
            ": where the touches are tells more than what they feel"
            if pose["error"] < skin["error"]
            else ""
        )
        sentences.append(
            f"In pipeline best, positions and normals alone reach {_correct(pose)} correctly classified, "
            f"imprints alone {_correct(skin)}{tells}. All objects stand upright."
        )
    mapped, without = (found.get(("paper", name)) for name in ("with its map", "without the map"))
    if mapped and without:
        sentences.append(
            "The paper reduces each touch to five numbers by a self-organising map. Without it "
            f"its pipeline has {_correct(without)} correctly classified, with it {_correct(mapped)}."
        )
    return sentences


def step_rows(rows: Sequence[Row]) -> list[Row]:
    """Give the settings that are worth their time, the quickest first.

    The first is the most accurate of those as quick as the quickest; each further one is significantly
    slower and significantly more accurate than the one before.
    """
    first = first_step(rows)
    if first is None:
        return []
    further = [row for row in rows if row["step"] and row is not first]
    return [first, *sorted(further, key=lambda row: -float(row["error"]))]


def robot_sentence(rows: Sequence[Row], cost: CostParameters) -> str:
    """Say up to which price of a look looking pays on a robot; empty where one strategy was measured."""
    found = break_even(rows)
    if found is None or not any(row["looks"] for row in rows):
        return ""
    blind = (
        f"Without a look, {counted(all_touches(found.blind), 'touch')} give the lowest error rate, "
        f"{percent(found.error)}"
    )
    price = found.touches_a_look
    if found.looking is None or price is None:
        return f"{blind}; no setting that looks is as accurate."
    touches = counted(all_touches(found.looking), "touch")
    looked = f"{touches} with {counted(found.looking['looks'], 'look')} are as accurate"
    if price <= 0:
        return f"{blind}; {looked}, so a look saves no touch."
    return (
        f"{blind}; {looked}. So looking saves time if a look takes less than "
        f"{price * cost.touch_seconds:.3g} s (here {cost.look_seconds:g} s)."
    )


def saving_sentences(rows: Sequence[Row], run: ExperimentParameters) -> list[str]:
    """Say what each smaller setting saves, and what it loses."""
    confidence = f"{100 * run.recognition.intervals.confidence:g} %"
    return [_saving_sentence(saving, confidence) for saving in find_savings(rows)]


def _groups(rows: Sequence[Row]) -> tuple[SettingGroup, ...]:
    found: dict[int, list[Row]] = {}
    for row in rows:
        found.setdefault(row["group"], []).append(row)
    return tuple(SettingGroup(tuple(group)) for group in found.values())


def _saving_sentence(saving: Saving, confidence: str) -> str:
    row = saving.row
    said = f"{titled(_named(row))} ({_changes(row)}) saves {percent(saving.saved, 0)} of the time"
    ends = f"{points(row['lost_low'])} to {points(row['lost_high'])}"
    if saving.verdict == "free":
        return f"{said} and costs less than 1 point of accuracy with {confidence} confidence."
    if saving.verdict == "open":
        return (
            f"{said}; its accuracy can't be told apart from the run's own with "
            f"{counted(row['objects'], 'object')} ({ends} points of error rate)."
        )
    return f"{said} and costs {points(row['lost'])} points of error rate ({ends})."


def _changes(row: Row) -> str:
    changes = json.loads(row["changes"])
    return listed([f"{name} {_short(value)}" for name, value in changes.items()])


def _milliseconds(seconds: float) -> str:
    return f"{1000 * seconds:.0f}"


def _short(value: object) -> str:
    if isinstance(value, dict):
        return listed([name for name, weight in value.items() if weight])
    return listed(value) if isinstance(value, list) else str(value)


def _named(row: Row) -> str:
    return f"{strategy_name(row['family'])}, {row['setting']}"


def _correct(row: Row) -> str:
    ends = f"{percent(1 - row['error_high'])} to {percent(1 - row['error_low'])}"
    return f"{percent(1 - row['error'])} ({ends})"


def _with_quartiles(row: Row) -> str:
    """Write a median run time with its quartiles."""
    low, high = duration(row["seconds_low"]), duration(row["seconds_high"])
    return f"{duration(row['seconds'])} ({low} to {high})"


def duration(seconds: float, digits: int = 2) -> str:
    """Write seconds, or milliseconds where they are few."""
    if seconds >= 1:
        return f"{seconds:.0f} s" if seconds >= 99.5 else f"{seconds:.{digits}g} s"
    return f"{1000 * seconds:.{digits}g} ms" if seconds < 0.0995 else f"{1000 * seconds:.0f} ms"
