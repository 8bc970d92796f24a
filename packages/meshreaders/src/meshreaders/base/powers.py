"""Compute powers with the same bits on every processor.

NumPy and the C library choose instructions by processor, so last digits differ between processors. The functions of
this module use only additions, multiplications and divisions of float64, because IEEE 754 defines their rounding.
Errors are a few units in the last place.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from meshreaders.base.arrays import FloatArray

# Two addends of ln 2: the first has so few digits that its multiples are exact.
_LN_2 = (0.6931471803691238, 1.9082149292705877e-10)
# The first omitted term of each series is below 1e-17 of the sum.
_EXPONENTIAL = [1.0 / math.factorial(k) for k in range(15)]
_LOGARITHM = [2.0 / (2 * k + 1) for k in range(12)]
_BLOCK = 1 << 13


def exponential(values: ArrayLike) -> FloatArray:
    """Compute e to the power of values of any shape; values of -700 to 700."""
    power = np.asarray(values, dtype=np.float64)
    doublings = np.rint(power / _LN_2[0])
    rest = power - doublings * _LN_2[0] - doublings * _LN_2[1]
    return np.ldexp(series(_EXPONENTIAL, rest), doublings.astype(np.int64))


def logarithm(values: ArrayLike) -> FloatArray:
    """Compute the natural logarithm of positive values of any shape."""
    fraction, doublings = np.frexp(np.asarray(values, dtype=np.float64))
    small = fraction < math.sqrt(0.5)
    fraction = np.where(small, 2.0 * fraction, fraction)
    doublings = doublings - small
    ratio = (fraction - 1.0) / (fraction + 1.0)
    tail = ratio * series(_LOGARITHM, ratio * ratio)
    return doublings * _LN_2[0] + (tail + doublings * _LN_2[1])


def power(values: ArrayLike, exponent: float) -> FloatArray:
    """Compute the power of values of at least 0, of any shape, with a positive exponent."""
    return by_blocks(lambda base: _power(base, exponent), values)


def by_blocks(function: Callable[..., FloatArray], *values: ArrayLike) -> FloatArray:
    """Apply a function element by element, in blocks, so that its arrays fit into the processor's cache."""
    arrays = np.broadcast_arrays(*(np.asarray(value, dtype=np.float64) for value in values))
    flat = [array.reshape(-1) for array in arrays]
    result = np.empty(arrays[0].size)
    for start in range(0, len(result), _BLOCK):
        block = slice(start, start + _BLOCK)
        result[block] = function(*(array[block] for array in flat))
    return result.reshape(arrays[0].shape)


def series(coefficients: Sequence[float], values: FloatArray) -> FloatArray:
    """Compute a power series by Horner's rule."""
    total = np.full_like(values, coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        total *= values
        total += coefficient
    return total


def _power(base: FloatArray, exponent: float) -> FloatArray:
    positive = base > 0.0
    raised = exponential(exponent * logarithm(np.where(positive, base, 1.0)))
    return np.where(positive, raised, 0.0)
