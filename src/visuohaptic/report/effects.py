"""Effects and channels that were simulated or computed, those that were not needed, and why."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import pyarrow as pa

from visuohaptic.attention.parameters import CHANNELS
from visuohaptic.scene.parameters import EffectModes


@dataclass(frozen=True)
class EffectSum:
    """One effect over all touches or views.

    Attributes
    ----------
    name : str
        The effect.
    modes, reasons : tuple of str
        All that occur: when it may be simulated, and why it was needed or not.
    occasions, called_for, runs : int
        Touches (views, for an effect of the view), those that needed it, those it was
        simulated for.
    seconds : float
        Time spent on it, deciding included.
    """

    name: str
    modes: tuple[str, ...]
    reasons: tuple[str, ...]
    occasions: int
    called_for: int
    runs: int
    seconds: float


@dataclass(frozen=True)
class ChannelSum:
    """One channel of attention over all views: in how many it ran, and why not in the others."""

    name: str
    ran: int
    skipped: int
    reasons: tuple[str, ...]


def sum_effects(table: pa.Table) -> list[EffectSum]:
    """Sum up the effect log over all jobs.

    Parameters
    ----------
    table : pyarrow.Table
        `tables.EFFECTS`.

    Returns
    -------
    list of EffectSum
        In the scene's order.
    """
    order = {name: place for place, name in enumerate(EffectModes.model_fields)}
    rows: dict[str, list[Mapping[str, Any]]] = {}
    for row in table.to_pylist():
        rows.setdefault(row["effect"], []).append(row)
    return [
        EffectSum(
            name=name,
            modes=_distinct(row["mode"] for row in rows[name]),
            reasons=_distinct(row["reason"] for row in rows[name]),
            occasions=sum(row["touches"] for row in rows[name]),
            called_for=sum(row["called_for"] for row in rows[name]),
            runs=sum(row["runs"] for row in rows[name]),
            seconds=sum(row["seconds"] for row in rows[name]),
        )
        for name in sorted(rows, key=lambda name: (order.get(name, len(order)), name))
    ]


def sum_channels(views: pa.Table) -> list[ChannelSum]:
    """Count in how many views each channel of attention ran.

    Parameters
    ----------
    views : pyarrow.Table
        `tables.VIEWS`.

    Returns
    -------
    list of ChannelSum
        In the model's order.
    """
    ran: dict[str, int] = {}
    reasons: dict[str, list[str]] = {}
    for maps in views.column("conspicuity").to_pylist():
        for channel, _ in maps:
            ran[channel] = ran.get(channel, 0) + 1
    for skipped in views.column("skipped").to_pylist():
        for channel, reason in skipped:
            reasons.setdefault(channel, []).append(reason)
    names = [*CHANNELS, *sorted({*ran, *reasons} - set(CHANNELS))]
    return [
        ChannelSum(
            name, ran.get(name, 0), len(reasons.get(name, [])), _distinct(reasons.get(name, []))
        )
        for name in names
    ]


def _distinct(values: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(values))
