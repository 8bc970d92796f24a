"""Random places among those that the viewpoint sees."""

from __future__ import annotations

import numpy as np

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.fixations.attended_views import Viewpoint
from visuohaptic.fixations.places import (
    BATCH,
    FRUITLESS_BATCHES,
    ProbingLocations,
    draw_by_area,
    sees,
    turn_towards,
)
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.raycasting import RayCaster


def choose(
    one: Viewpoint, attention: AttentionParameters, generator: np.random.Generator
) -> ProbingLocations:
    """Choose among what the viewpoint sees."""
    return draw_visible(one.caster, one.camera, attention.fixations, generator)


def draw_visible(
    caster: RayCaster, camera: Camera, count: int, generator: np.random.Generator
) -> ProbingLocations:
    """Draw points uniformly, by area, over what a viewpoint sees, with normals towards the camera.

    Fewer are the first of more. They are drawn over the whole surface and kept where seen: pixels would
    count slanted parts less, and hold no place between them.
    """
    parts: list[ProbingLocations] = []
    found = fruitless = 0
    while found < count and fruitless < FRUITLESS_BATCHES:
        drawn = draw_by_area(caster.surface, BATCH, generator)
        parts.append(drawn.take(np.flatnonzero(sees(caster, camera, drawn.points))))
        found += len(parts[-1].faces)
        fruitless = 0 if len(parts[-1].faces) else fruitless + 1
    seen = _join(parts).take(np.arange(min(count, found)))
    return turn_towards(seen, camera)


def _join(parts: list[ProbingLocations]) -> ProbingLocations:
    return ProbingLocations(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.faces for part in parts]),
    )
