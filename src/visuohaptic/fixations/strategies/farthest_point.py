"""Places that are each as far as can be from those before."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.fixations.looking import Standpoint
from visuohaptic.fixations.places import ProbingLocations, draw_by_area, face_outwards
from visuohaptic.geometry.surface import Surface

CANDIDATES = 4096
"""Points, uniform by area, among which `spread_far` chooses."""


def choose(
    one: Standpoint, attention: AttentionParameters, generator: np.random.Generator
) -> ProbingLocations:
    """Spread places over the whole surface."""
    spread = spread_far(one.caster.surface, attention.fixations, generator)
    return face_outwards(one.caster, spread)


def spread_far(surface: Surface, count: int, generator: np.random.Generator) -> ProbingLocations:
    """Spread points over a surface, each as far as can be from all before it.

    Parameters
    ----------
    surface : Surface
        The object.
    count : int
        How many points, at most `CANDIDATES`; fewer points are the first of more.
    generator : numpy.random.Generator
        Draws the first point, and the candidates among which the others are chosen.

    Returns
    -------
    ProbingLocations
        `count` points; their covering radius over the candidates is at most twice the least that
        so many points can reach (T. F. Gonzalez, Theor. Comput. Sci. 38, 1985).
    """
    candidates = draw_by_area(surface, CANDIDATES, generator)
    return candidates.take(farthest_order(candidates.points, count))


def farthest_order(points: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    """Order points so that each is the farthest from those before it.

    Parameters
    ----------
    points : numpy.ndarray
        Shape (n, d), n at least 1; the first starts.
    count : int
        How many to take.

    Returns
    -------
    numpy.ndarray
        Shape (min(count, n),), int64: places, no place twice.
    """
    chosen = np.zeros(min(count, len(points)), dtype=np.int64)
    nearest = np.full(len(points), np.inf)
    for turn in range(1, len(chosen)):
        step = points - points[chosen[turn - 1]]
        nearest = np.minimum(nearest, np.einsum("nd,nd->n", step, step))
        # Equal points have distance 0 as taken ones do; these must not come again.
        nearest[chosen[:turn]] = -1.0
        chosen[turn] = np.argmax(nearest)
    return chosen
