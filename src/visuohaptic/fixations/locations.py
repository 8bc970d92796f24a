"""Probing locations of a viewpoint, as rows of `tables.FIXATIONS`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.scanpath import Scanpath
from visuohaptic.base.draw_names import draw_of
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.fixations.attended_views import Viewpoint
from visuohaptic.fixations.places import (
    ProbingLocations,
    face_outwards,
    is_visible,
    turn_towards,
)
from visuohaptic.fixations.probing import PLANNED, Strategy, entry_of
from visuohaptic.tables.phases import FIXATIONS, NORMAL_NAMES, POINT_NAMES, SPARE, owner_columns
from visuohaptic.tables.schema import build_table

Locations = ProbingLocations | Scanpath
"""Locations of a viewpoint in the order of touching; only a `Scanpath` has pixels and saliency."""


def locate(
    viewpoints: Sequence[Viewpoint],
    strategies: Sequence[str],
    attention: AttentionParameters,
    seed: int,
) -> pa.Table:
    """Choose the probing locations of an object's viewpoints with strategies.

    A run with fewer fixations has a prefix of the same rows of each viewpoint and strategy.

    Parameters
    ----------
    viewpoints : sequence of Viewpoint
        Viewpoints of one object, at least one; `AttendedView` for strategies that need a view.
    strategies : sequence of str
        Names of strategies, or of draws of strategies.
    attention : AttentionParameters
        Number and distance of fixations.
    seed : int
        Seed of the run. The random numbers depend on seed, strategy, draw, object and viewpoint only.

    Returns
    -------
    pyarrow.Table
        Rows of `tables.FIXATIONS` in the order of viewpoints, then strategies: of each up to `SPARE` more than the
        number of fixations.

    Raises
    ------
    RegistryError
        If no planned strategy has one of the names.
    """
    with_spares = attention.model_copy(update={"fixations": attention.fixations + SPARE})
    entries: dict[str, Strategy] = {name: entry_of(PLANNED, name) for name in strategies}
    chosen: dict[tuple[int, str], Locations] = {}
    for viewpoint, (name, entry) in product(viewpoints, entries.items()):
        generator = spawn_generator(
            seed, entry.random_stream or name, viewpoint.key, viewpoint.number
        )
        chosen[viewpoint.number, name] = entry.choose(viewpoint, with_spares, generator)
    unturned = {
        each: part
        for each, part in chosen.items()
        if isinstance(part, ProbingLocations) and not part.is_turned
    }
    # The rays of all viewpoints and strategies are cast together.
    turned = face_outwards(viewpoints[0].caster, list(unturned.values()))
    return location_table(viewpoints[0].key, chosen | dict(zip(unturned, turned, strict=True)))


def candidate_table(viewpoint: Viewpoint, candidates: ProbingLocations) -> pa.Table:
    """Return the candidates that a viewpoint sees, in order, as rows of strategy ``adaptive``."""
    caster, camera = viewpoint.caster, viewpoint.camera
    visible = candidates.take(np.flatnonzero(is_visible(caster, camera, candidates.points)))
    turned = turn_towards(visible, camera)
    return location_table(viewpoint.key, {(viewpoint.number, "adaptive"): turned})


def location_table(key: str, chosen: Mapping[tuple[int, str], Locations]) -> pa.Table:
    """Return the locations of an object as rows of `tables.FIXATIONS`.

    `chosen` has the locations by viewpoint and strategy, in the order of the rows. Only a `Scanpath` has pixels and
    saliency; other locations have missing values there.
    """
    if not chosen:
        return FIXATIONS.arrow.empty_table()
    parts, counts = list(chosen.values()), [len(part.faces) for part in chosen.values()]
    # Study touch_curves passes `adaptive`, which is not in the registry.
    names = [strategy for _, strategy in chosen]
    entries = [
        entry_of(PLANNED, name) if draw_of(name)[0] in PLANNED.names else None for name in names
    ]
    streams = [
        (entry and entry.random_stream) or name for name, entry in zip(names, entries, strict=True)
    ]

    def each(values: Sequence[object]) -> NDArray[np.object_]:
        return np.repeat(np.array(values, dtype=object), counts)

    def seen(name: str) -> NDArray[Any]:
        return np.concatenate(
            [getattr(part, name, np.full(len(part.faces), None)) for part in parts]
        )

    columns: dict[str, object] = {
        **owner_columns(key),
        "viewpoint": each([viewpoint for viewpoint, _ in chosen]),
        "strategy": each(names),
        "touch": np.concatenate([np.arange(count) for count in counts]),
        "face": seen("faces"),
        "pixel_row": seen("rows"),
        "pixel_column": seen("columns"),
        "saliency": seen("saliency"),
        "unreachable": each([entry and entry.unreachable for entry in entries]),
        "random_stream": each(streams),
    }
    columns |= dict(zip(POINT_NAMES, seen("points").T, strict=True))
    columns |= dict(zip(NORMAL_NAMES, seen("normals").T, strict=True))
    return build_table(FIXATIONS, columns)
