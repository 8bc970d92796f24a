"""The registry of descriptors, which describe an imprint by numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contourlets import (
    Contourlet,
    LevelsError,
    NonsubsampledContourlet,
    band_deviations,
    wavelet_deviations,
)
from visuohaptic.base.errors import ParameterError
from visuohaptic.base.registry import Registry
from visuohaptic.features.imprint_shape import describe_imprint_shape
from visuohaptic.geometry.layouts import Layout


@dataclass(frozen=True)
class Descriptor:
    """A description of an imprint by numbers.

    Attributes
    ----------
    name, label : str
        Name in parameters and tables, and name in the report.
    describe : callable
        ``describe(imprints, parameters)`` takes imprints (n, r, r), float32, 0 to 1, and the section `features`. It
        returns numbers (n, k), float64, with k at most 16. Each row must depend only on its own imprint.
    any_layout : bool
        Whether the function takes any layout: ``describe(imprints, parameters, layout)``, with imprints (n, taxels) and
        the `Layout`, or imprints (n, r, r) and None. By default only imprints of a square grid are described.
    """

    name: str
    label: str
    describe: Callable[..., NDArray[np.float64]]
    any_layout: bool = False


def _contourlet_deviations(imprints: NDArray[np.float32], parameters: Any) -> NDArray[np.float64]:
    try:
        transform = Contourlet(
            parameters.levels,
            parameters.pyramid_filter,
            parameters.directional_filter,
            parameters.extension,
        )
        return band_deviations(imprints, transform)
    except LevelsError:
        if parameters.levels != (4,):
            raise
        raise ParameterError(
            f"sensor.resolution is {imprints.shape[1]}; 16 contourlet bands need a multiple of 8 or an "
            "odd number of 3 or more."
        ) from None


def _nonsubsampled_deviations(imprints: NDArray[np.float32], _: object) -> NDArray[np.float64]:
    """Compute the standard deviations, with N - 1, of the 16 bands of a nonsubsampled contourlet."""
    bands = NonsubsampledContourlet(levels=(4,)).forward(imprints.astype(np.float64)).levels[0]
    return np.stack([band.std(axis=(1, 2), ddof=1) for band in bands], axis=1)


def _wavelet_deviations(imprints: NDArray[np.float32], parameters: Any) -> NDArray[np.float64]:
    return wavelet_deviations(imprints, "db2", parameters.wavelet_levels)


def _image_statistics(
    imprints: NDArray[np.float32], _: object, layout: Layout | None
) -> NDArray[np.float64]:
    return describe_imprint_shape(imprints, layout)


def any_layout_names() -> list[str]:
    """Return the names of the descriptors that take any layout."""
    return [entry.name for entry in DESCRIPTORS if entry.any_layout]


DESCRIPTORS = Registry(
    "descriptor of imprints",
    Descriptor("contourlet", "deviations of 16 contourlet bands", _contourlet_deviations),
    Descriptor("nonsubsampled_contourlet", "nonsubsampled contourlet", _nonsubsampled_deviations),
    Descriptor("wavelet", "wavelet (db2)", _wavelet_deviations),
    Descriptor(
        "image_statistics", "statistics of the raw imprint", _image_statistics, any_layout=True
    ),
)
