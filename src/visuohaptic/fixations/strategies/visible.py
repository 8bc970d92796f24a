"""Strategy `random_visible`: locations uniform by area over the visible surface."""

from __future__ import annotations

import numpy as np

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.fixations.attended_views import Viewpoint
from visuohaptic.fixations.places import (
    BATCH,
    FRUITLESS_BATCHES,
    ProbingLocations,
    draw_by_area,
    is_visible,
    turn_towards,
)
from visuohaptic.fixations.viewpoints import Camera
from visuohaptic.geometry.raycasting import RayCaster


def choose(
    viewpoint: Viewpoint, attention: AttentionParameters, generator: np.random.Generator
) -> ProbingLocations:
    """Draw locations over the visible surface."""
    return draw_visible(viewpoint.caster, viewpoint.camera, attention.fixations, generator)


def draw_visible(
    caster: RayCaster, camera: Camera, count: int, generator: np.random.Generator
) -> ProbingLocations:
    """Draw points uniformly by area over the visible surface, with normals towards the camera.

    A smaller `count` returns a prefix of the same points. Points are drawn over the whole surface, and hidden points
    are rejected. A draw of pixels would have fewer points on slanted parts.
    """
    parts: list[ProbingLocations] = []
    total = fruitless = 0
    while total < count and fruitless < FRUITLESS_BATCHES:
        drawn = draw_by_area(caster.surface, BATCH, generator)
        visible = drawn.take(np.flatnonzero(is_visible(caster, camera, drawn.points)))
        parts.append(visible)
        total += len(visible.faces)
        fruitless = 0 if len(visible.faces) else fruitless + 1
    return turn_towards(_join(parts).take(np.arange(min(count, total))), camera)


def _join(parts: list[ProbingLocations]) -> ProbingLocations:
    return ProbingLocations(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.faces for part in parts]),
    )
