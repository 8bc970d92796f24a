"""Effects and channels that were simulated or computed, those that were not needed, and why."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

import pyarrow as pa

from visuohaptic.attention.parameters import CHANNELS
from visuohaptic.scene.parameters import EffectModes


def sum_effects(table: pa.Table) -> list[Mapping[str, Any]]:
    """Sum up the effect log over all jobs.

    Parameters
    ----------
    table : pyarrow.Table
        `tables.EFFECTS`.

    Returns
    -------
    list of mapping
        A row an effect, in the scene's order: ``effect``, ``touches_sum``, ``runs_sum`` and
        ``seconds_sum``, and all that occur in ``mode_distinct`` and ``reason_distinct``.
    """
    order = {name: place for place, name in enumerate(EffectModes.model_fields)}
    sums = [(name, "sum") for name in ("touches", "runs", "seconds")]
    texts = [(name, "distinct") for name in ("mode", "reason")]
    rows = table.group_by("effect", use_threads=False).aggregate([*sums, *texts]).to_pylist()
    return sorted(rows, key=lambda row: (order.get(row["effect"], len(order)), row["effect"]))


def sum_channels(views: pa.Table) -> list[tuple[str, int, int, str]]:
    """Give each channel of attention, in how many views it ran and was skipped, and why, from `tables.VIEWS`."""
    ran = Counter(name for maps in views.column("conspicuity").to_pylist() for name, _ in maps)
    skipped = [pair for pairs in views.column("skipped").to_pylist() for pair in pairs]
    left_out = Counter(name for name, _ in skipped)
    names = [*CHANNELS, *sorted({*ran, *left_out} - set(CHANNELS))]
    return [(name, ran[name], left_out[name], _reasons(name, skipped)) for name in names]


def _reasons(channel: str, skipped: list[tuple[str, str]]) -> str:
    return "; ".join(dict.fromkeys(reason for name, reason in skipped if name == channel))
