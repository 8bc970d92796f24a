"""Compute elementary functions with the same bits on every processor.

NumPy and the C library choose instructions by processor, so last digits differ between processors. The functions of this module use
only additions, multiplications, divisions and square roots of float64, because IEEE 754 defines their rounding. Errors are
a few units in the last place.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from visuohaptic.base.arrays import FloatArray

# Two addends of pi / 2 and of ln 2: the first has so few digits that its multiples are exact.
_QUARTER_TURN = (1.5707963267341256, 6.077100506506192e-11)
_LN_2 = (0.6931471803691238, 1.9082149292705877e-10)
# The first omitted term of each series is below 1e-17 of the sum.
_SINE = [(-1.0) ** k / math.factorial(2 * k + 1) for k in range(10)]
_COSINE = [(-1.0) ** k / math.factorial(2 * k) for k in range(10)]
_EXPONENTIAL = [1.0 / math.factorial(k) for k in range(15)]
_ARC_TANGENT = [(-1.0) ** k / (2 * k + 1) for k in range(12)]
_LOGARITHM = [2.0 / (2 * k + 1) for k in range(12)]
_BLOCK = 1 << 13


def sin_cos(angles: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Compute sine and cosine of angles in radians, of any shape; absolute values up to 1e5."""
    turned = np.asarray(angles, dtype=np.float64)
    quarters = np.rint(turned / (0.5 * math.pi))
    rest = turned - quarters * _QUARTER_TURN[0] - quarters * _QUARTER_TURN[1]
    square = rest * rest
    sine, cosine = rest * _series(_SINE, square), _series(_COSINE, square)
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
    return _by_blocks(_arc_tangent, across, along)


def exponential(values: ArrayLike) -> FloatArray:
    """Compute e to the power of values of any shape; values of -700 to 700."""
    power = np.asarray(values, dtype=np.float64)
    doublings = np.rint(power / _LN_2[0])
    rest = power - doublings * _LN_2[0] - doublings * _LN_2[1]
    return np.ldexp(_series(_EXPONENTIAL, rest), doublings.astype(np.int64))


def logarithm(values: ArrayLike) -> FloatArray:
    """Compute the natural logarithm of positive values of any shape."""
    fraction, doublings = np.frexp(np.asarray(values, dtype=np.float64))
    small = fraction < math.sqrt(0.5)
    fraction = np.where(small, 2.0 * fraction, fraction)
    doublings = doublings - small
    ratio = (fraction - 1.0) / (fraction + 1.0)
    tail = ratio * _series(_LOGARITHM, ratio * ratio)
    return doublings * _LN_2[0] + (tail + doublings * _LN_2[1])


def power(values: ArrayLike, exponent: float) -> FloatArray:
    """Compute the power of values of at least 0, of any shape, with a positive exponent."""
    return _by_blocks(lambda base: _power(base, exponent), values)


def _by_blocks(function: Callable[..., FloatArray], *values: ArrayLike) -> FloatArray:
    """Apply a function element by element, in blocks, so that its arrays fit into the processor's cache."""
    arrays = np.broadcast_arrays(*(np.asarray(value, dtype=np.float64) for value in values))
    flat = [array.reshape(-1) for array in arrays]
    result = np.empty(arrays[0].size)
    for start in range(0, len(result), _BLOCK):
        block = slice(start, start + _BLOCK)
        result[block] = function(*(array[block] for array in flat))
    return result.reshape(arrays[0].shape)


def _power(base: FloatArray, exponent: float) -> FloatArray:
    positive = base > 0.0
    raised = exponential(exponent * logarithm(np.where(positive, base, 1.0)))
    return np.where(positive, raised, 0.0)


def _arc_tangent(across: FloatArray, along: FloatArray) -> FloatArray:
    width = np.abs(along)
    longer = np.maximum(across, width)
    longer[longer == 0.0] = 1.0
    ratio = np.minimum(across, width)
    ratio /= longer
    # The tangent of half of the angle, then of a quarter.
    for _ in range(2):
        ratio /= 1.0 + np.sqrt(1.0 + ratio * ratio)
    angle = _series(_ARC_TANGENT, ratio * ratio)
    angle *= 4.0 * ratio
    np.subtract(0.5 * math.pi, angle, out=angle, where=across > width)
    np.subtract(math.pi, angle, out=angle, where=along < 0.0)
    return angle


def _series(coefficients: Sequence[float], values: FloatArray) -> FloatArray:
    """Compute a power series by Horner's rule."""
    total = np.full_like(values, coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        total *= values
        total += coefficient
    return total
