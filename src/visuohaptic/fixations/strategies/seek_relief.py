"""Policy `seek_relief`: touch where the imprints so far let expect relief, or where nothing near was touched."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.fixations.policies import Felt, PolicyView
from visuohaptic.geometry.elementary import arc_tangent

VARIANCE_WEIGHT = 1.0
"""Weight of how much near imprints differ, α."""

DISTANCE_WEIGHT = 0.5
"""Weight of how far the place is from all touches, δ; α and δ are the defaults of the authors' package GLIS."""

TOUCHED = 1e-6
"""A place that is as near to a touch, object radii, is not touched again."""


def next_location(view: PolicyView, touches: Sequence[Felt]) -> FloatArray | None:
    """Return the place that the viewpoint sees with the largest score; any place before the first touch.

    Relief is the standard deviation of an imprint, and 0 where the sensor could not come. The score is
    the acquisition function of A. Bemporad, Comput. Optim. Appl. 77, 2020, eq. 11, for the largest relief
    instead of the least cost: the relief expected by inverse-distance weighting, the spread of the relief
    around, and the distance to all touches.
    """
    points = view.places.points
    if not len(points):
        return None
    if not touches:
        return points[view.generator.integers(len(points))]
    squares = np.stack([_squares(points, felt.point) for felt in touches], axis=1)
    relief = np.array([_relief(felt) for felt in touches])
    scores = acquisition(squares, relief)
    scores[(squares <= TOUCHED**2).any(axis=1)] = -np.inf
    best = int(np.argmax(scores))
    return points[best] if np.isfinite(scores[best]) else None


def acquisition(squares: FloatArray, values: FloatArray) -> FloatArray:
    """Compute the score of p places, by squared distances (p, n) to n touches with values (n,): shape (p,)."""
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


def _squares(points: FloatArray, point: FloatArray) -> FloatArray:
    steps = points - point
    return np.einsum("nd,nd->n", steps, steps)
