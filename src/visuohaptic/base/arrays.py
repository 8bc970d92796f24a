"""Types of arrays."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]
BoolArray: TypeAlias = NDArray[np.bool_]


def masked_fault(values: object) -> str | None:
    """Return the end of an error "points has ..." for an array, or a list of arrays, with masked values; else None.

    `numpy.asarray` drops masks, so masked values would count as if they were not masked.
    """
    parts = values if isinstance(values, list | tuple) else (values,)
    if any(np.ma.is_masked(part) for part in parts if isinstance(part, np.ma.MaskedArray)):
        return "masked values; fill or leave them out first, because masks are not read"
    return None
