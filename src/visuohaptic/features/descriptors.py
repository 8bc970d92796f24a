"""Descriptors: the numbers that describe an imprint, one entry each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visuohaptic.base.registry import Registry


@dataclass(frozen=True)
class Descriptor:
    """What describes an imprint.

    Attributes
    ----------
    name : str
        What parameters and tables call it.
    label : str
        What the report calls it.
    describe : callable
        Takes imprints, shape (n, r, r), float32, in [0, 1], and the section `features`; gives
        numbers, shape (n, k), float64, k at most 16. Each row depends on its own imprint alone.
    """

    name: str
    label: str
    describe: Callable[..., NDArray[np.float64]]


def _of(function: str) -> Callable[..., NDArray[np.float64]]:
    """Return a function of `imprint_numbers` that imports the transforms on its first call: names are checked without."""
    return partial(_describe, function)


def _describe(function: str, *arguments: Any) -> NDArray[np.float64]:
    from visuohaptic.features import imprint_numbers

    found: NDArray[np.float64] = getattr(imprint_numbers, function)(*arguments)
    return found


DESCRIPTORS = Registry(
    "descriptor of imprints",
    Descriptor("contourlet", "deviations of 16 contourlet bands", _of("contourlet_deviations")),
    Descriptor(
        "nonsubsampled_contourlet", "nonsubsampled contourlet", _of("nonsubsampled_deviations")
    ),
    Descriptor("wavelet", "wavelet (db2)", _of("wavelet_deviations")),
    Descriptor("image_statistics", "statistics of the raw imprint", _of("image_statistics")),
)
