"""Probing locations of a viewpoint, as rows of `tables.FIXATIONS`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pyarrow as pa

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.scanpath import Scanpath
from visuohaptic.base.draw_names import draw_of
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.fixations.attended_views import Viewpoint
from visuohaptic.fixations.places import ProbingLocations, is_visible, turn_towards
from visuohaptic.fixations.probing import PLANNED, Strategy, entry_of
from visuohaptic.tables.phases import FIXATIONS, NORMAL_NAMES, POINT_NAMES, SPARE, owner_columns
from visuohaptic.tables.schema import build_table


def locate(
    viewpoint: Viewpoint, strategy: str, attention: AttentionParameters, seed: int
) -> pa.Table:
    """Choose the probing locations of a viewpoint with a strategy.

    A run with fewer fixations has a prefix of the same rows.

    Parameters
    ----------
    viewpoint : Viewpoint
        The viewpoint; an `AttendedView` for strategies that need a view.
    strategy : str
        Name of a strategy, or of a draw of a strategy.
    attention : AttentionParameters
        Number and distance of fixations.
    seed : int
        Seed of the run. The random numbers depend on seed, strategy, draw, object and viewpoint only.

    Returns
    -------
    pyarrow.Table
        Rows of `tables.FIXATIONS`: up to `SPARE` more than the number of fixations.

    Raises
    ------
    RegistryError
        If no planned strategy has the name.
    """
    entry: Strategy = entry_of(PLANNED, strategy)
    generator = spawn_generator(
        seed, entry.random_stream or strategy, viewpoint.key, viewpoint.number
    )
    with_spares = attention.model_copy(update={"fixations": attention.fixations + SPARE})
    chosen = entry.choose(viewpoint, with_spares, generator)
    return location_table(viewpoint.key, viewpoint.number, strategy, chosen)


def candidate_table(viewpoint: Viewpoint, candidates: ProbingLocations) -> pa.Table:
    """Return the candidates that a viewpoint sees, in order, as rows of strategy ``adaptive``."""
    caster, camera = viewpoint.caster, viewpoint.camera
    visible = candidates.take(np.flatnonzero(is_visible(caster, camera, candidates.points)))
    turned = turn_towards(visible, camera)
    return location_table(viewpoint.key, viewpoint.number, "adaptive", turned)


def location_table(
    key: str, viewpoint: int, strategy: str, chosen: ProbingLocations | Scanpath
) -> pa.Table:
    """Return chosen locations as rows of `tables.FIXATIONS`.

    Only a `Scanpath` has pixels and saliency; other locations have missing values there.
    """
    # Study touch_curves passes `adaptive`, which is not in the registry.
    is_registered = draw_of(strategy)[0] in PLANNED.names
    entry = entry_of(PLANNED, strategy) if is_registered else None
    count = len(chosen.faces)
    pixels: Sequence[object] = [[None] * count] * 3
    if isinstance(chosen, Scanpath):
        pixels = (chosen.rows, chosen.columns, chosen.saliency)
    columns: dict[str, object] = {
        **owner_columns(key),
        "viewpoint": viewpoint,
        "strategy": strategy,
        "touch": np.arange(count),
        "face": chosen.faces,
        **dict(zip(("pixel_row", "pixel_column", "saliency"), pixels, strict=True)),
        "unreachable": [entry and entry.unreachable] * count,
        "random_stream": (entry and entry.random_stream) or strategy,
    }
    columns |= dict(zip(POINT_NAMES, chosen.points.T, strict=True))
    columns |= dict(zip(NORMAL_NAMES, chosen.normals.T, strict=True))
    return build_table(FIXATIONS, columns)
