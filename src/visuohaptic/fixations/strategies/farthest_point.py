"""Strategy `farthest_point`: each location is as far as possible from all locations before."""

from __future__ import annotations

import numpy as np

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.fixations.attended_views import Viewpoint
from visuohaptic.fixations.places import ProbingLocations, draw_by_area
from visuohaptic.geometry.surface import Surface

CANDIDATES = 4096
"""Points, uniform by area, from which `spread_far` chooses."""


def choose(
    viewpoint: Viewpoint, attention: AttentionParameters, generator: np.random.Generator
) -> ProbingLocations:
    """Spread locations over the whole surface."""
    return spread_far(viewpoint.caster.surface, attention.fixations, generator)


def spread_far(surface: Surface, count: int, generator: np.random.Generator) -> ProbingLocations:
    """Spread at most `CANDIDATES` points over a surface, each as far as possible from all points before.

    The covering radius over the candidates is at most twice the optimum for as many points (T. F. Gonzalez, Theor.
    Comput. Sci. 38, 1985).
    """
    candidates = draw_by_area(surface, CANDIDATES, generator)
    return candidates.take(farthest_order(candidates.points, count))


def farthest_order(points: FloatArray, count: int) -> IntArray:
    """Return indices of at most `count` points (n, d), each farthest from all points before; the first is 0."""
    chosen = np.zeros(min(count, len(points)), dtype=np.int64)
    nearest = np.full(len(points), np.inf)
    for position in range(1, len(chosen)):
        step = points - points[chosen[position - 1]]
        nearest = np.minimum(nearest, np.einsum("nd,nd->n", step, step))
        # Below the distance 0 of a point's duplicates, so that no index is chosen twice.
        nearest[chosen[:position]] = -1.0
        chosen[position] = np.argmax(nearest)
    return chosen
