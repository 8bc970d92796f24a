"""Places that are each as far as can be from those before."""

from __future__ import annotations

import numpy as np

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.fixations.attended_views import Viewpoint
from visuohaptic.fixations.places import ProbingLocations, draw_by_area, face_outwards
from visuohaptic.geometry.surface import Surface

CANDIDATES = 4096
"""Points, uniform by area, among which `spread_far` chooses."""


def choose(
    one: Viewpoint, attention: AttentionParameters, generator: np.random.Generator
) -> ProbingLocations:
    """Spread places over the whole surface."""
    spread = spread_far(one.caster.surface, attention.fixations, generator)
    return face_outwards(one.caster, spread)


def spread_far(surface: Surface, count: int, generator: np.random.Generator) -> ProbingLocations:
    """Spread at most `CANDIDATES` points over a surface, each as far as can be from all before it.

    Their covering radius over the candidates is at most twice the least that so many points can reach
    (T. F. Gonzalez, Theor. Comput. Sci. 38, 1985).
    """
    candidates = draw_by_area(surface, CANDIDATES, generator)
    return candidates.take(farthest_order(candidates.points, count))


def farthest_order(points: FloatArray, count: int) -> IntArray:
    """Order points (n, d) so that each is the farthest from those before it; the first starts, none is twice."""
    chosen = np.zeros(min(count, len(points)), dtype=np.int64)
    nearest = np.full(len(points), np.inf)
    for turn in range(1, len(chosen)):
        step = points - points[chosen[turn - 1]]
        nearest = np.minimum(nearest, np.einsum("nd,nd->n", step, step))
        # Equal points have distance 0 as taken ones do; these must not come again.
        nearest[chosen[:turn]] = -1.0
        chosen[turn] = np.argmax(nearest)
    return chosen
