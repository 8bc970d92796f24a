"""Points and directions as a caller gives them, checked."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import ParameterError

LARGEST = 1e100
"""Largest magnitude of a coordinate or a length, so that products of three are finite."""


def point_rows(values: ArrayLike | None, name: str) -> FloatArray:
    """Give an array (n, 3) of finite numbers; `ParameterError`, which names it, where it is none."""
    try:
        rows = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise ParameterError(f"{name} holds no numbers; an array (n, 3) is needed.") from None
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise ParameterError(f"{name} has the shape {rows.shape}; (n, 3) is needed.")
    broken = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(broken):
        raise ParameterError(f"{name} has NaN or infinite numbers, the first in row {broken[0]}.")
    check_magnitudes(rows, name)
    return rows


def check_magnitudes(rows: FloatArray, name: str) -> None:
    """Raise `ParameterError`, which names the row, if an array (n, …) holds a number beyond `LARGEST`."""
    large = np.argwhere(np.abs(rows) > LARGEST)
    if len(large):
        raise ParameterError(
            f"{name} has {rows[tuple(large[0])]:g} in row {large[0, 0]}; numbers up to {LARGEST:g} are allowed."
        )


def lengths_of(directions: FloatArray) -> FloatArray:
    """Compute the lengths of directions (n, k) of at most `LARGEST`, however short, shape (n, 1)."""
    # Scaling by a power of two loses no digit, and squares of short directions are not 0.
    exponents = np.frexp(np.abs(directions).max(axis=1, keepdims=True, initial=0.0))[1]
    scaled = np.linalg.norm(np.ldexp(directions, -exponents), axis=1, keepdims=True)
    lengths: FloatArray = np.ldexp(scaled, exponents)
    return lengths


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
