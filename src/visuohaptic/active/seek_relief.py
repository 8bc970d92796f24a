"""Policy `seek_relief`: touch where earlier imprints predict relief, or far from all earlier touches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from visuohaptic.active.policies import Felt, PolicyView
from visuohaptic.base.arrays import FloatArray
from visuohaptic.geometry.elementary import arc_tangent

VARIANCE_WEIGHT = 1.0
"""Weight α of the variance of the relief nearby; default of GLIS, the package of the method's author."""

DISTANCE_WEIGHT = 0.5
"""Weight δ of the distance from all touches; default of GLIS."""

TOUCHED = 1e-6
"""A location within this distance of a touch, object radii, is not touched again."""


def next_location(view: PolicyView, touches: Sequence[Felt]) -> FloatArray | None:
    """Return the visible location (3,), object frame, with the largest score; a random location for the first touch.

    The score is the acquisition function of A. Bemporad, Comput. Optim. Appl. 77, 2020, eq. 11, with relief to be
    maximised in place of a cost. It sums the relief expected by inverse-distance weighting, the spread of relief
    nearby, and the distance from all touches. Relief is the standard deviation of an imprint, 0 without an imprint.
    """
    points = view.places.points
    if not len(points):
        return None
    if not touches:
        return points[view.generator.integers(len(points))]
    squares = np.stack([_squared_distances(points, felt.point) for felt in touches], axis=1)
    relief = np.array([_relief(felt) for felt in touches])
    scores = acquisition(squares, relief)
    scores[(squares <= TOUCHED**2).any(axis=1)] = -np.inf
    best = int(np.argmax(scores))
    return points[best] if np.isfinite(scores[best]) else None


def acquisition(squares: FloatArray, values: FloatArray) -> FloatArray:
    """Compute the scores (p,) of p locations.

    `squares` (p, n) are squared distances from the locations to n touches, `values` (n,) the touches' reliefs.
    """
    weights = 1.0 / np.maximum(squares, TOUCHED**2)
    total = weights.sum(axis=1)
    shares = weights / total[:, None]
    expected = np.einsum("pn,n->p", shares, values)
    spread = np.sqrt(np.einsum("pn,pn->p", shares, (values - expected[:, None]) ** 2))
    distance = 2.0 / np.pi * arc_tangent(1.0, total)
    span = float(np.ptp(values)) or 1.0
    return expected + VARIANCE_WEIGHT * spread + DISTANCE_WEIGHT * span * distance


def _relief(felt: Felt) -> float:
    return 0.0 if felt.imprint is None else float(felt.imprint.std(dtype=np.float64))


def _squared_distances(points: FloatArray, point: FloatArray) -> FloatArray:
    steps = points - point
    return np.einsum("nd,nd->n", steps, steps)
