"""What accuracy costs in time: steps worth their time, and what smaller settings save."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from markupsafe import Markup

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.report.estimates import Figure, figure_of, with_interval
from visuohaptic.report.questions import Answer, pipeline_name
from visuohaptic.report.tables import NONE
from visuohaptic.report.wording import counted, duration, listed, percent, strategy_name, titled
from visuohaptic.studies.cost.front import (
    Row,
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

_VERDICTS = {
    "free": "costs less than 1 point",
    "open": "no clear difference",
    "costs": "costs accuracy",
}
_CUES = {
    ("cues", "pose alone", "skin alone"): "In pipeline best, positions and normals alone reach {} "
    "correctly classified, imprints alone {}. All objects stand upright.",
    (
        "paper",
        "with its map",
        "without the map",
    ): "The paper reduces each touch to five numbers by a "
    "self-organising map. With it its pipeline has {} correctly classified, without it {}.",
}


@dataclass(frozen=True)
class CostFigures:
    """What accuracy costs in a run: rows of `tables.COST`, and what was run."""

    rows: Sequence[Row]
    run: ExperimentParameters

    @property
    def timed(self) -> bool:
        """Whether a setting was both run and timed."""
        return bool(timed(self.rows))

    @property
    def steps(self) -> list[Row]:
        """Settings that are worth their time, the quickest first; each has its ``name``.

        The first is the most accurate of those as quick as the quickest; each further one is significantly
        slower and significantly more accurate than the one before.
        """
        first = first_step(self.rows)
        further = [row for row in self.rows if row["step"] and row is not first]
        further.sort(key=lambda row: -float(row["error"]))
        steps = [] if first is None else [first, *further]
        return [{**row, "name": _named(row)} for row in steps]

    @property
    def groups(self) -> list[Row]:
        """Settings that differ significantly neither in time nor in error, a row together."""
        groups = dict.fromkeys(row["group"] for row in self.rows)
        return [_group_row([row for row in self.rows if row["group"] == one]) for one in groups]

    @property
    def savings(self) -> list[Row]:
        """What each smaller setting saves, and what it loses."""
        return [_saving_row(saving) for saving in find_savings(self.rows)]

    @property
    def price(self) -> str:
        """Up to which price of a look looking pays on a robot; empty where one strategy was measured."""
        found = break_even(self.rows)
        if found is None or not any(row["looks"] for row in self.rows):
            return ""
        blind = (
            f"Without a look, {counted(all_touches(found.blind), 'touch')} give the lowest error rate, "
            f"{percent(found.error)}"
        )
        price, cost = found.touches_a_look, self.run.cost
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

    @property
    def robot(self) -> Sequence[Row]:
        """The rows with a robot's time."""
        return on_robot(list(self.rows), self.run.cost)

    @property
    def recognitions(self) -> int:
        """Recognitions that each setting was timed on, at most."""
        return max((row["recognitions"] or 0 for row in self.rows), default=0)

    @property
    def objects(self) -> int:
        """Objects that were tested, at most."""
        return max((row["objects"] or 0 for row in self.rows), default=0)

    @property
    def reference(self) -> Row | None:
        """The row of the run's own setting from one viewpoint."""
        return reference_row(self.rows)


def read_cost(path: Path | None, run: ExperimentParameters) -> CostFigures | None:
    """Read what accuracy costs from `tables.COST`; None where nothing was measured."""
    rows = read_costs(path) if path else []
    return CostFigures(rows, run) if rows else None


def timed(rows: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Give the rows of `tables.COST` that have both seconds and an error rate."""
    return [row for row in rows if row["failed"] is None and row["seconds"] is not None]


def cost_verdict(rows: Sequence[Row]) -> Answer | None:
    """Answer what accuracy costs in time: the quickest step and the most accurate setting."""
    first = first_step(rows)
    if first is None:
        return None
    last = min(front_rows(rows), key=lambda row: float(row["error"]))
    error, best = percent(first["error"]), first["error"] <= last["error"]
    named = f"{_named(first)}, {pipeline_name(first['pipeline'])}"
    sentence = (
        f"of computing, error rate {error} ({named}): the quickest setting has the lowest error "
        "rate, too."
        if best
        else f"of computing for an error rate of {error} ({named}); the lowest, "
        f"{percent(last['error'])}, takes {duration(last['seconds'])}."
    )
    seconds = Figure(first["seconds"], first["seconds_low"], first["seconds_high"])
    return Answer(
        "What does accuracy cost in time?",
        "no" if best else "depends",
        with_interval(seconds, duration),
        sentence,
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
    """Say where the time of a recognition goes, by a row of `tables.COST`; empty if it was not timed."""
    if row is None or row["seconds"] is None:
        return []
    whole, views = (1, "recognition"), (row["looks"], "view")
    touches = (all_touches(row), "touch")
    looking = row["seconds_render"] + row["seconds_attend"]
    parts = (
        ("preparing the surface", row["seconds_look"] - looking, whole),
        ("rendering", row["seconds_render"], views),
        ("attention: saliency and fixations", row["seconds_attend"], views),
        ("casting rays", row["seconds_cast"], touches),
        ("rest of touching", row["seconds_touch"] - row["seconds_cast"], touches),
        ("describing", row["seconds_describe"], touches),
        ("classification", row["seconds_classify"], whole),
    )
    # Medians of parts need not add up.
    return [TimePart(name, max(seconds, 0.0), *units) for name, seconds, units in parts if units[0]]


def cue_sentences(rows: Sequence[Row]) -> list[str]:
    """Say what positions alone and imprints alone are worth, and the map of the paper's pipeline."""
    found = {
        (row["family"], row["setting"]): with_interval(_correct(row), percent)
        for row in rows
        if row["error"] is not None
    }
    return [
        sentence.format(found[family, one], found[family, other])
        for (family, one, other), sentence in _CUES.items()
        if {(family, one), (family, other)} <= found.keys()
    ]


def _group_row(rows: Sequence[Row]) -> Row:
    """Give the table's row of settings that are alike, rows of `tables.COST`, with ranges as texts."""
    families = dict.fromkeys(row["family"] for row in rows)
    settings = (
        (strategy_name(one), "; ".join(row["setting"] for row in rows if row["family"] == one))
        for one in families
    )
    limit = "†" if any(row["error"] in (0.0, 1.0) for row in rows) else ""
    return {
        "settings": Markup("").join(
            Markup('<span class="setting">{}: {}</span>').format(*one) for one in settings
        ),
        "seconds": _range_above(rows, "seconds", "{:.0f}", 1000, "{:.0f}"),
        "error": _range_above(rows, "error", "{:.2f}", 100, "{:.1f}", limit),
        **{
            part: _range(rows, f"seconds_{part}", f"seconds_{part}", "{:.1f}", 1000)
            for part in ("look", "touch", "describe", "classify")
        },
        "verdict": _verdict(rows),
        "mark": "best" if any(row["on_front"] for row in rows) else None,
    }


def _saving_row(saving: Saving) -> Row:
    changes = json.loads(saving.row["changes"])
    return {
        "setting": titled(_named(saving.row)),
        "changes": listed([f"{name} {_short(value)}" for name, value in changes.items()]),
        "saved": saving.saved,
        "lost": figure_of(saving.row, "lost"),
        "verdict": _VERDICTS[saving.verdict],
        "objects": saving.row["objects"],
    }


def _verdict(rows: Sequence[Row]) -> str:
    if rows[0]["failed"]:
        return f"failed: {rows[0]['failed']}"
    if any(row["on_front"] for row in rows):
        return "on the front"
    return "dominated" if rows[0]["dominated"] else "not timed"


def _range_above(
    rows: Sequence[Row], name: str, form: str, scale: float, ends_as: str, limit: str = ""
) -> Markup:
    ends = _range(rows, f"{name}_low", f"{name}_high", ends_as, scale)
    return Markup('{}<span class="interval">{}{}</span>').format(
        _range(rows, name, name, form, scale), ends, limit
    )


def _range(rows: Sequence[Row], low: str, high: str, form: str, scale: float) -> str:
    """Write the lowest and the highest value of rows, once if they are written alike."""
    if rows[0][low] is None:
        return NONE
    ends = min(row[low] for row in rows), max(row[high] for row in rows)
    write: Callable[[float], str] = form.format
    return "\N{EN DASH}".join(dict.fromkeys(write(scale * end) for end in ends))


def _short(value: object) -> str:
    if isinstance(value, dict):
        return listed([name for name, weight in value.items() if weight])
    return listed(value) if isinstance(value, list) else str(value)


def _named(row: Row) -> str:
    return f"{strategy_name(row['family'])}, {row['setting']}"


def _correct(row: Row) -> Figure:
    return Figure(1 - row["error"], 1 - row["error_high"], 1 - row["error_low"])
