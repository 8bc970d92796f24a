"""What accuracy costs in time: steps worth their time, and what smaller settings save."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from markupsafe import Markup

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.report.estimates import Figure, figure_of, with_interval
from visuohaptic.report.questions import Answer, pipeline_name
from visuohaptic.report.tables import NONE
from visuohaptic.report.wording import duration, listed, percent, strategy_name, titled
from visuohaptic.studies.cost.front import (
    Row,
    all_touches,
    find_savings,
    first_step,
    front_rows,
    on_robot,
    read_costs,
    reference_row,
)

POINT = 0.01
"""A loss of accuracy that does not matter to most users."""
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


def read_cost(path: Path | None, run: ExperimentParameters) -> Row | None:
    """Read what accuracy costs from `tables.COST`; None where nothing was measured."""
    rows = read_costs(path) if path else []
    return cost_figures(rows, run) if rows else None


def cost_figures(rows: Sequence[Row], run: ExperimentParameters) -> Row:
    """Give what the page shows of ``rows`` of `tables.COST`.

    ``steps`` are settings worth their time: the most accurate of the quickest, then each slower and more
    accurate one. ``reference`` is the run's own setting from one viewpoint.
    """
    first = first_step(rows)
    further = [row for row in rows if row["step"] and row is not first]
    further.sort(key=lambda row: -float(row["error"]))
    steps = [] if first is None else [first, *further]
    return {
        "rows": rows,
        "timed": bool(timed(rows)),
        "steps": [{**row, "name": _named(row)} for row in steps],
        "settings": [_setting_row(row) for row in rows],
        "savings": [_saving_row(row) for row in find_savings(rows)],
        "robot": on_robot(list(rows), run.cost),
        "recognitions": max((row["recognitions"] or 0 for row in rows), default=0),
        "objects": max((row["objects"] or 0 for row in rows), default=0),
        "reference": reference_row(rows),
    }


def timed(rows: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Give the rows of `tables.COST` that have both seconds and an error rate."""
    return [row for row in rows if row["failed"] is None and row["seconds"] is not None]


def cost_verdict(rows: Sequence[Row]) -> Answer | None:
    """Answer what accuracy costs in time: the quickest step and the most accurate setting."""
    first = first_step(rows)
    if first is None:
        return None
    last = min(front_rows(rows), key=lambda row: float(row["error"]))
    best = first["error"] <= last["error"]
    rate = f"{percent(first['error'])} ({_named(first)}, {pipeline_name(first['pipeline'])})"
    lowest = f"the lowest, {percent(last['error'])}, takes {duration(last['seconds'])}."
    sentence = (
        f"of computing, error rate {rate}: the quickest setting has the lowest error rate, too."
        if best
        else f"of computing for an error rate of {rate}; {lowest}"
    )
    seconds = Figure(first["seconds"], first["seconds_low"], first["seconds_high"])
    return Answer(
        "What does accuracy cost in time?",
        "no" if best else "depends",
        with_interval(seconds, duration),
        sentence,
        "cost",
    )


def time_parts(row: Row | None) -> list[Row]:
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
    found = [(name, max(seconds, 0.0), *units) for name, seconds, units in parts if units[0]]
    return [
        {"name": name, "seconds": seconds, "each": f"{duration(seconds / units)} a {unit}"}
        for name, seconds, units, unit in found
    ]


def cue_sentences(rows: Sequence[Row]) -> list[str]:
    """Say what positions alone and imprints alone are worth, and the map of the paper's pipeline."""
    found = {
        (row["family"], row["setting"]): with_interval(
            Figure(*(1 - row[f"error{end}"] for end in ("", "_high", "_low"))), percent
        )
        for row in rows
        if row["error"] is not None
    }
    return [
        sentence.format(found[family, one], found[family, other])
        for (family, one, other), sentence in _CUES.items()
        if {(family, one), (family, other)} <= found.keys()
    ]


def _setting_row(row: Row) -> Row:
    limit = "†" if row["error"] in {0.0, 1.0} else ""
    return {
        "setting": titled(_named(row)),
        "seconds": _with_ends(row, "seconds", 1000, ".0f"),
        "error": _with_ends(row, "error", 100, ".1f", limit),
        **{
            part: NONE if row["seconds"] is None else f"{1000 * row[f'seconds_{part}']:.1f}"
            for part in ("look", "touch", "describe", "classify")
        },
        "verdict": _verdict(row),
        "mark": "best" if row["on_front"] else None,
    }


def _with_ends(row: Row, name: str, scale: float, form: str, limit: str = "") -> Markup | str:
    if row[name] is None:
        return NONE
    value, low, high = (f"{scale * row[name + end]:{form}}" for end in ("", "_low", "_high"))
    return Markup('{}<span class="interval">{}\N{EN DASH}{}{}</span>').format(
        value, low, high, limit
    )


def _verdict(row: Row) -> str:
    if row["failed"]:
        return f"failed: {row['failed']}"
    not_on_front = "dominated" if row["dominated"] else "not timed"
    return "on the front" if row["on_front"] else not_on_front


def _saving_row(row: Row) -> Row:
    changes = []
    for name, value in json.loads(row["changes"]).items():
        shown = (
            [one for one, weight in value.items() if weight] if isinstance(value, dict) else value
        )
        changes.append(f"{name} {listed(shown) if isinstance(shown, list) else shown}")
    if row["lost_high"] < POINT:
        verdict = "costs less than 1 point"
    else:
        verdict = "no clear difference" if row["lost_low"] <= 0 else "costs accuracy"
    return {
        "setting": titled(_named(row)),
        "changes": listed(changes),
        "saved": row["saved"],
        "lost": figure_of(row, "lost"),
        "verdict": verdict,
        "objects": row["objects"],
    }


def _named(row: Row) -> str:
    return f"{strategy_name(row['family'])}, {row['setting']}"
