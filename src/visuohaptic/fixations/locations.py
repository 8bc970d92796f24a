"""Probing locations of a viewpoint, as rows of a table."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pyarrow as pa

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.scanpath import Scanpath
from visuohaptic.base.draws import draw_of
from visuohaptic.base.errors import RegistryError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.fixations.attended_views import Viewpoint
from visuohaptic.fixations.places import ProbingLocations, sees, turn_towards
from visuohaptic.fixations.policies import Policy
from visuohaptic.fixations.probing import STRATEGIES, strategy_of
from visuohaptic.tables.phases import FIXATIONS, NORMAL_NAMES, POINT_NAMES, SPARE, owner_columns
from visuohaptic.tables.schema import build_table


def locate(one: Viewpoint, strategy: str, attention: AttentionParameters, seed: int) -> pa.Table:
    """Choose where to touch: rows of `tables.FIXATIONS`, up to `SPARE` more than fixations are asked for.

    Fewer are the first of more. What is drawn depends on seed, strategy, draw, object and viewpoint only. `one` is
    a `AttendedView` where the strategy looks. Raises `RegistryError` if there is no such strategy, or it is a policy.
    """
    entry = strategy_of(strategy)
    if isinstance(entry, Policy):
        raise RegistryError(
            f"{strategy!r} is a policy, which chooses by what was felt; phase touches runs it."
        )
    generator = spawn_generator(seed, entry.chance or strategy, one.key, one.viewpoint)
    more = attention.model_copy(update={"fixations": attention.fixations + SPARE})
    chosen = entry.choose(one, more, generator)
    return location_table(one.key, one.viewpoint, strategy, chosen)


def candidate_table(one: Viewpoint, crowd: ProbingLocations) -> pa.Table:
    """List those of an object's points that a viewpoint sees, for strategy ``adaptive``, in their order."""
    shown = crowd.take(np.flatnonzero(sees(one.caster, one.camera, crowd.points)))
    turned = turn_towards(shown, one.camera)
    return location_table(one.key, one.viewpoint, "adaptive", turned)


def location_table(
    key: str, viewpoint: int, strategy: str, chosen: ProbingLocations | Scanpath
) -> pa.Table:
    """Give locations as rows of `tables.FIXATIONS`; those not chosen by pixel have none, and no saliency."""
    # Study touch_curves has a strategy of its own, `adaptive`.
    known = draw_of(strategy)[0] in STRATEGIES.names
    entry = strategy_of(strategy) if known else None
    count = len(chosen.faces)
    looked: Sequence[object] = [[None] * count] * 3
    if isinstance(chosen, Scanpath):
        looked = (chosen.rows, chosen.columns, chosen.saliency)
    columns: dict[str, object] = {
        **owner_columns(key),
        "viewpoint": viewpoint,
        "strategy": strategy,
        "touch": np.arange(count),
        "face": chosen.faces,
        **dict(zip(("pixel_row", "pixel_column", "saliency"), looked, strict=True)),
        "unreachable": [entry and entry.unreachable] * count,
        "chance": (entry and entry.chance) or strategy,
    }
    columns |= dict(zip(POINT_NAMES, chosen.points.T, strict=True))
    columns |= dict(zip(NORMAL_NAMES, chosen.normals.T, strict=True))
    return build_table(FIXATIONS, columns)
