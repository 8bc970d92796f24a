"""Points and directions as a caller gives them, checked."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import ParameterError

FARTHEST = 1e100
"""Coordinates and lengths beyond are refused: their squares would overflow."""


def point_rows(values: ArrayLike | None, name: str) -> FloatArray:
    """Return an array (n, 3) of numbers below `FARTHEST`; `ParameterError`, which names it, where it is none."""
    try:
        rows = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise ParameterError(f"{name} holds no numbers; an array (n, 3) is needed.") from None
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
    lengths = np.linalg.norm(rows, axis=1, keepdims=True)
    lost = np.flatnonzero(~(lengths > 0) | np.isinf(lengths))
    if len(lost):
        raise ParameterError(f"{name} has no direction in row {lost[0]}: {rows[lost[0]]}.")
    return rows / lengths
