"""Checks of points and directions that a caller passes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from visuohaptic.base.arrays import FloatArray, masked_fault
from visuohaptic.base.errors import ParameterError

FARTHEST = 1e100
"""Limit of coordinates and lengths. The squares of larger numbers could overflow."""


def numbers(values: ArrayLike | None, name: str) -> FloatArray:
    """Return `values` as float64. Raise `ParameterError`, with `name`, if they are no numbers, truth values or masked."""
    if fault := masked_fault(values):
        raise ParameterError(f"{name} has {fault}.")
    try:
        given = np.asarray(values)
        converted = given.astype(np.float64)
    except OverflowError as error:
        raise ParameterError(f"{name} holds a number that float64 can't hold.") from error
    # The `__array__` of an object may raise anything.
    except Exception as error:
        raise ParameterError(f"{name} holds no numbers; an array of them is needed.") from error
    # Whole numbers beyond 64 bits are objects.
    is_large = given.dtype == object and {*map(type, given.flat)} <= {int, float}
    if given.dtype.kind not in "iuf" and not is_large:
        raise ParameterError(f"{name} is of type {given.dtype}; numbers are needed.")
    return converted


def lengths_of(directions: FloatArray) -> FloatArray:
    """Compute the lengths of directions (n, k) below `FARTHEST`, exact for short directions too: (n, 1)."""
    # Scaling by a power of two loses no digit, and squares of short directions are not 0.
    exponents = np.frexp(np.abs(directions).max(axis=1, keepdims=True, initial=0.0))[1]
    scaled = np.linalg.norm(np.ldexp(directions, -exponents), axis=1, keepdims=True)
    lengths: FloatArray = np.ldexp(scaled, exponents)
    return lengths


def point_rows(values: ArrayLike | None, name: str, farthest: float = FARTHEST) -> FloatArray:
    """Return `values` as an array (n, 3). Raise `ParameterError`, with `name`, for other shapes and numbers.

    Numbers must be below `farthest`.
    """
    rows = numbers(values, name)
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise ParameterError(f"{name} has the shape {rows.shape}; (n, 3) is needed.")
    broken = np.flatnonzero(~(np.abs(rows) < farthest).all(axis=1))
    if len(broken):
        raise ParameterError(
            f"{name} has NaN, infinite numbers or numbers beyond {farthest:g}, the first in row {broken[0]}."
        )
    return rows


def unit_rows(values: ArrayLike | None, name: str, count: int) -> FloatArray:
    """Return `count` unit directions (count, 3). Raise `ParameterError` as `point_rows` does, or for length 0."""
    rows = point_rows(values, name)
    if len(rows) != count:
        raise ParameterError(f"There are {len(rows)} {name} for {count} points.")
    lengths = lengths_of(rows)
    zero = np.flatnonzero(lengths == 0)
    if len(zero):
        raise ParameterError(f"{name} has no direction in row {zero[0]}: {rows[zero[0]]}.")
    return rows / lengths
