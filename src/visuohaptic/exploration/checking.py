"""Points and directions as a caller gives them, checked."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import ParameterError

FARTHEST = 1e100
"""Coordinates and lengths beyond are refused: their squares would overflow."""


def numbers(values: ArrayLike | None, name: str) -> FloatArray:
    """Return an array of numbers, float64; `ParameterError`, which names it, if it holds none or truth values."""
    try:
        given = np.asarray(values)
        found = given.astype(np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ParameterError(f"{name} holds no numbers; an array of them is needed.") from None
    if given.dtype.kind not in "iuf":
        raise ParameterError(f"{name} is of type {given.dtype}; numbers are needed.")
    return found


def lengths_of(directions: FloatArray) -> FloatArray:
    """Compute the lengths of directions (n, k) below `FARTHEST`, however short, shape (n, 1)."""
    # Scaling by a power of two loses no digit, and squares of short directions are not 0.
    exponents = np.frexp(np.abs(directions).max(axis=1, keepdims=True, initial=0.0))[1]
    scaled = np.linalg.norm(np.ldexp(directions, -exponents), axis=1, keepdims=True)
    lengths: FloatArray = np.ldexp(scaled, exponents)
    return lengths


def point_rows(values: ArrayLike | None, name: str) -> FloatArray:
    """Return an array (n, 3) of numbers below `FARTHEST`; `ParameterError`, which names it, where it is none."""
    rows = numbers(values, name)
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise ParameterError(f"{name} has the shape {rows.shape}; (n, 3) is needed.")
    broken = np.flatnonzero(~(np.abs(rows) < FARTHEST).all(axis=1))
    if len(broken):
        raise ParameterError(
            f"{name} has NaN, infinite numbers or such beyond {FARTHEST:g}, the first in row {broken[0]}."
        )
    return rows


def unit_rows(values: ArrayLike | None, name: str, count: int) -> FloatArray:
    """Give as many directions as there are points, of length 1; `ParameterError` as `point_rows` does."""
    rows = point_rows(values, name)
    if len(rows) != count:
        raise ParameterError(f"There are {len(rows)} {name} for {count} points.")
    lengths = lengths_of(rows)
    lost = np.flatnonzero(lengths == 0)
    if len(lost):
        raise ParameterError(f"{name} has no direction in row {lost[0]}: {rows[lost[0]]}.")
    return rows / lengths
