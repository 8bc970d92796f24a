"""Accuracy against time: settings that are worth their time, and savings of smaller settings."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from markupsafe import Markup

from visuohaptic.parameters import CostParameters, ExperimentParameters
from visuohaptic.report.cells import NONE
from visuohaptic.report.estimates import Estimate, estimate_of, with_interval
from visuohaptic.report.questions import Answer
from visuohaptic.report.wording import (
    duration,
    listed,
    percent,
    pipeline_name,
    strategy_name,
    titled,
)
from visuohaptic.studies.cost.cost_rows import Row, mark_front, read_costs

POINT = 0.01
"""A loss of accuracy, as a share, that does not matter to most users."""

Compared = Literal["cues", "paper"]
"""A family of settings with a sentence on two of them."""

_COMPARED: Mapping[Compared, tuple[str, str, str]] = {
    "cues": (
        "pose alone",
        "skin alone",
        (
            "In pipeline order_free, positions and normals without imprints reach {0} correctly classified, "
            "imprints without positions and normals {1}."
        ),
    ),
    "paper": (
        "with its map",
        "without the map",
        (
            "The paper reduces each touch to five numbers by a self-organising map. Without the map, the paper's pipeline "
            "reaches {1} correctly classified."
        ),
    ),
}


def read_cost(path: Path | None, run: ExperimentParameters) -> Row | None:
    """Read `tables.COST` and return the result of `cost_figures`; None without rows."""
    rows = read_costs(path) if path else []
    return cost_figures(rows, run) if rows else None


def cost_figures(rows: Sequence[Row], run: ExperimentParameters) -> Row:
    """Return the figures that the page shows of rows of `tables.COST`.

    ``steps`` are the settings that are worth their time: the most accurate of the quickest settings, then each slower
    and more accurate setting. ``settings`` has one row per setting, and ``savings`` the rows of `find_savings`.
    ``robot`` has the rows with a robot's time. ``reference`` is the run's own setting from one viewpoint.
    """
    return {
        "rows": rows,
        "timed": bool(timed(rows)),
        "steps": [
            {
                **row,
                "name": _named(row),
                "seconds": estimate_of(row, "seconds"),
                "error": estimate_of(row, "error"),
            }
            for row in find_steps(rows)
        ],
        "settings": [_setting_row(row) for row in rows],
        "savings": find_savings(rows),
        "robot": on_robot(by_strategy(rows), run.cost),
        "recognitions": max((row["recognitions"] or 0 for row in rows), default=0),
        "objects": max((row["objects"] or 0 for row in rows), default=0),
        "reference": reference_row(rows),
    }


def timed(rows: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Return the rows of `tables.COST` that have both seconds and an error rate."""
    return [row for row in rows if row["failed"] is None and row["seconds"] is not None]


def find_steps(rows: Sequence[Row]) -> list[Row]:
    """Return the settings that are worth their time, the quickest first."""
    steps = [row for row in rows if row["step"]]
    return sorted(steps, key=lambda row: (not row["as_quick"], -row["error"]))


def reference_row(rows: Sequence[Row]) -> Row | None:
    """Return the row of the run's own setting from one viewpoint; None if it is not among the rows."""
    return next((row for row in rows if row["lost_low"] == 0 == row["lost_high"]), None)


def by_strategy(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of settings that differ from the run's own only in strategy, touches and viewpoints."""
    return [row for row in rows if row["family"] == row["strategy"]]


def on_robot(rows: Sequence[Row], cost: CostParameters) -> list[Row]:
    """Add the seconds of a robot's touches and looks to rows of `tables.COST`, and mark the front again."""
    with_robot = []
    for row in rows:
        price = robot_price(row, cost)
        times = ("seconds", "seconds_low", "seconds_high")
        with_robot.append(
            row | {name: row[name] + price for name in times if row[name] is not None}
        )
    return mark_front(with_robot)


def robot_price(row: Mapping[str, Any], cost: CostParameters) -> float:
    """Return the seconds that a robot takes for the touches and looks of a row of `tables.COST`."""
    return cost.touch_seconds * _all_touches(row) + cost.look_seconds * int(row["looks"])


def robot_front(rows: Sequence[Row], cost: CostParameters) -> list[Row]:
    """Return the settings of `by_strategy` on the front by a robot's time, the quickest first."""
    front = [row for row in on_robot(by_strategy(rows), cost) if row["on_front"]]
    return sorted(front, key=lambda row: float(row["seconds"]))


def cost_answer(rows: Sequence[Row], cost: CostParameters) -> Answer | None:
    """Return the answer on accuracy against a robot's time; None without settings on the front.

    The answer names the quickest and the most accurate setting on the front, and the computing time.
    """
    front = robot_front(rows, cost)
    if not front:
        return None
    computing = sorted(row["seconds"] for row in timed(rows))
    first, last = front[0], front[-1]
    lowest = (
        "no slower setting has a lower error rate"
        if first is last
        else f"the lowest error rate, {_error(last)}, takes {duration(last['seconds'])} ({_described(last)})"
    )
    return Answer(
        "What does accuracy cost in time?",
        "",
        duration(first["seconds"]),
        f"is the quickest recognition, with an error rate of {_error(first)} ({_described(first)}); {lowest}. The times "
        f"are a robot's: {cost.touch_seconds:g} s per touch and {cost.look_seconds:g} s per look, both assumed, and "
        f"{duration(computing[0])} to {duration(computing[-1])} of computing.",
        "cost",
        rule="The quickest and the most accurate of the settings that no other setting beats in both time and error "
        "rate. In brackets: intervals over objects.",
    )


def _error(row: Row) -> str:
    figure = estimate_of(row, "error")
    return with_interval(figure, percent) if figure else ""


def _described(row: Row) -> str:
    return f"{_named(row)}, {pipeline_name(row['pipeline'])}"


def time_parts(row: Row | None) -> list[Row]:
    """Return the median seconds of each part of a recognition in a row of `tables.COST`; empty if it was not timed.

    Each part has ``name``, ``seconds``, and ``each``: the time per view, touch or recognition in words.
    """
    if row is None or row["seconds"] is None:
        return []
    whole, views = (1, "recognition"), (row["looks"], "view")
    touches = (_all_touches(row), "touch")
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
    # Differences of medians may be negative.
    return [
        {
            "name": name,
            "seconds": max(seconds, 0.0),
            "each": f"{duration(max(seconds, 0.0) / units)} per {unit}",
        }
        for name, seconds, (units, unit) in parts
        if units
    ]


def compared_sentence(rows: Sequence[Row], family: Compared) -> str:
    """Return a sentence on imprints and poses by themselves (``cues``), or on the paper's pipeline without its map.

    `rows` are rows of `tables.COST`. Empty if one of the two settings was not measured.
    """
    first, second, sentence = _COMPARED[family]
    accuracy = {
        row["setting"]: with_interval(
            Estimate(*(1 - row[f"error{end}"] for end in ("", "_high", "_low"))), percent
        )
        for row in rows
        if row["family"] == family and row["error"] is not None
    }
    if not {first, second} <= accuracy.keys():
        return ""
    return sentence.format(accuracy[first], accuracy[second])


def _setting_row(row: Row) -> Row:
    return {
        "setting": titled(_named(row)),
        "seconds": _with_ends(row, "seconds", 1000, ".0f"),
        "error": _with_ends(row, "error", 100, ".1f"),
        **{
            part: NONE if row["seconds"] is None else f"{1000 * row[f'seconds_{part}']:.1f}"
            for part in ("look", "touch", "describe", "classify")
        },
        "verdict": _verdict(row),
        "mark": "best" if row["on_front"] else None,
    }


def _with_ends(row: Row, name: str, scale: float, form: str) -> Markup | str:
    if row[name] is None:
        return NONE
    value, low, high = (f"{scale * row[name + end]:{form}}" for end in ("", "_low", "_high"))
    return Markup('{}<span class="interval">{}\N{EN DASH}{}</span>').format(value, low, high)


def _verdict(row: Row) -> str:
    if row["failed"]:
        return f"failed: {row['failed']}"
    not_on_front = "dominated" if row["dominated"] else "not timed"
    return "on the front" if row["on_front"] else not_on_front


def find_savings(rows: Sequence[Row]) -> list[Row]:
    """Return the savings of quicker settings over the run's own setting, the largest saving first.

    Settings count if they are significantly quicker, have the same numbers of touches and viewpoints, and change no
    parameter of recognition. Empty if the run's own setting is not among the rows.
    """
    reference = reference_row(rows)
    if not reference:
        return []
    savings = [
        _saving_row(row, reference)
        for row in rows
        if row["quicker"]
        and row["lost_high"] is not None
        and (row["touches"], row["viewpoints"]) == (reference["touches"], reference["viewpoints"])
        and row["changes"] != "{}"
        and not any(name.startswith("recognition.") for name in json.loads(row["changes"]))
    ]
    return sorted(savings, key=lambda row: -float(row["saved"]))


def _saving_row(row: Row, reference: Row) -> Row:
    changes = []
    for name, value in json.loads(row["changes"]).items():
        shown = (
            [key for key, weight in value.items() if weight] if isinstance(value, dict) else value
        )
        changes.append(f"{name} {listed(shown) if isinstance(shown, list) else shown}")
    if row["lost_high"] < POINT:
        verdict = "costs less than 1 point"
    else:
        verdict = "no clear difference" if row["lost_low"] <= 0 else "costs accuracy"
    return {
        "setting": titled(_named(row)),
        "changes": listed(changes),
        "saved": 1 - row["seconds"] / reference["seconds"],
        "saved_seconds": reference["seconds"] - row["seconds"],
        "lost": estimate_of(row, "lost"),
        "verdict": verdict,
        "objects": row["objects"],
    }


def _all_touches(row: Mapping[str, Any]) -> int:
    return int(row["touches"] * row["viewpoints"])


def _named(row: Row) -> str:
    return f"{strategy_name(row['family'])}, {row['setting']}".removesuffix(", 1 viewpoint")
