"""Compute angles and their sines with the same bits on every processor.

NumPy and the C library choose instructions by processor, so last digits differ between processors. The functions of this module use
only additions, multiplications, divisions and square roots of float64, because IEEE 754 defines their rounding. Errors are
a few units in the last place.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from meshreaders.base.powers import by_blocks, series
from visuohaptic.base.arrays import FloatArray

# Two addends of pi / 2: the first has so few digits that its multiples are exact.
_QUARTER_TURN = (1.5707963267341256, 6.077100506506192e-11)
# The first omitted term of each series is below 1e-17 of the sum.
_SINE = [(-1.0) ** k / math.factorial(2 * k + 1) for k in range(10)]
_COSINE = [(-1.0) ** k / math.factorial(2 * k) for k in range(10)]
_ARC_TANGENT = [(-1.0) ** k / (2 * k + 1) for k in range(12)]


def sin_cos(angles: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Compute sine and cosine of angles in radians, of any shape; absolute values up to 1e5."""
    turned = np.asarray(angles, dtype=np.float64)
    quarters = np.rint(turned / (0.5 * math.pi))
    rest = turned - quarters * _QUARTER_TURN[0] - quarters * _QUARTER_TURN[1]
    square = rest * rest
    sine, cosine = rest * series(_SINE, square), series(_COSINE, square)
    quadrant = quarters.astype(np.int64) % 4
    odd = quadrant % 2 == 1
    first, second = np.where(odd, cosine, sine), np.where(odd, sine, cosine)
    return (
        np.where(quadrant >= 2, -first, first),
        np.where((quadrant == 1) | (quadrant == 2), -second, second),
    )


def tangent(angle: float) -> float:
    """Compute the tangent of an angle in radians."""
    sine, cosine = sin_cos(angle)
    return float(sine / cosine)


def arc_tangent(across: ArrayLike, along: ArrayLike) -> FloatArray:
    """Compute the angle between points (along, across) and the axis `along`: radians, 0 to pi; 0 at the origin.

    Shapes broadcast. `across` must be at least 0, as in ``np.arctan2(across, along)``.
    """
    return by_blocks(_arc_tangent, across, along)


def _arc_tangent(across: FloatArray, along: FloatArray) -> FloatArray:
    width = np.abs(along)
    longer = np.maximum(across, width)
    longer[longer == 0.0] = 1.0
    ratio = np.minimum(across, width)
    ratio /= longer
    # The tangent of half of the angle, then of a quarter.
    for _ in range(2):
        ratio /= 1.0 + np.sqrt(1.0 + ratio * ratio)
    angle = series(_ARC_TANGENT, ratio * ratio)
    angle *= 4.0 * ratio
    np.subtract(0.5 * math.pi, angle, out=angle, where=across > width)
    np.subtract(math.pi, angle, out=angle, where=along < 0.0)
    return angle
