"""Effects and channels that were simulated or computed, contacts that were met, and what was left out and why."""

from __future__ import annotations

from collections import Counter

import pyarrow as pa

from visuohaptic.attention.registry import CHANNELS
from visuohaptic.report.estimates import Row
from visuohaptic.report.run import Run
from visuohaptic.scene.parameters import EffectModes


def sum_effects(table: pa.Table) -> list[Row]:
    """Sum up `tables.EFFECTS` over all jobs, an effect a row, in the scene's order, with all modes and reasons."""
    order = {name: place for place, name in enumerate(EffectModes.model_fields)}
    sums = [(name, "sum") for name in ("touches", "runs", "seconds")]
    texts = [(name, "distinct") for name in ("mode", "reason")]
    rows = table.group_by("effect", use_threads=False).aggregate([*sums, *texts]).to_pylist()
    for row in rows:
        row |= {
            "modes": ", ".join(row["mode_distinct"]),
            "reasons": "; ".join(row["reason_distinct"]),
        }
    return sorted(rows, key=lambda row: (order.get(row["effect"], len(order)), row["effect"]))


def sum_channels(views: pa.Table) -> list[Row]:
    """Give each channel of attention, in how many `tables.VIEWS` it ``ran`` and was ``skipped``, and ``why``."""
    ran = Counter(name for maps in views.column("conspicuity").to_pylist() for name, _ in maps)
    skipped = [pair for pairs in views.column("skipped").to_pylist() for pair in pairs]
    left_out = Counter(name for name, _ in skipped)
    names = [*CHANNELS, *sorted({*ran, *left_out} - set(CHANNELS))]
    why = {name: dict.fromkeys(reason for one, reason in skipped if one == name) for name in names}
    return [
        {"channel": name, "ran": ran[name], "skipped": left_out[name], "why": "; ".join(why[name])}
        for name in names
    ]


def count_states(touches: pa.Table) -> dict[str, Counter[str]]:
    """Count the touches in each contact state, by strategy."""
    rows = touches.group_by(["strategy", "contact_state"]).aggregate([([], "count_all")])
    found: dict[str, Counter[str]] = {}
    for row in rows.to_pylist():
        found.setdefault(row["strategy"], Counter())[row["contact_state"]] = row["count_all"]
    return found


def count_passed_over(touches: pa.Table) -> Counter[str]:
    """Count the places that were passed over for being out of reach, by strategy."""
    sequence = ["class", "object", "viewpoint", "strategy"]
    found = touches.group_by(sequence).aggregate([("rank", "max"), ("rank", "count_distinct")])
    counts: Counter[str] = Counter()
    for row in found.to_pylist():
        counts[row["strategy"]] += row["rank_max"] + 1 - row["rank_count_distinct"]
    return counts


def count_missing(run: Run) -> Counter[str]:
    """Count the touches that were asked for and not made, by strategy."""
    asked = run.views.num_rows * run.parameters.attention.fixations
    made = Counter(run.touches.column("strategy").to_pylist())
    return Counter({strategy: asked - count for strategy, count in made.items()})
