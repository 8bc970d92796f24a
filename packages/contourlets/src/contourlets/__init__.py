"""Contourlets for Python: a multiscale, directional decomposition of images, and its inverse.

`Contourlet` is the decimated transform of Do and Vetterli with the numbers of the reference Matlab
toolbox. The package needs only NumPy. The module `contourlets.transformer`, which needs scikit-learn
and is imported by its name, has scikit-learn transformers of band features.
"""

from .errors import (
    CoefficientsError,
    ContourletError,
    ExtensionError,
    FilterError,
    ImageError,
    LevelsError,
)
from .features import band_deviations, band_energies, band_names, directional_deviations
from .filters import (
    DIRECTIONAL_FILTERS,
    diamond_filters,
    ladder_taps,
    pyramid_filter_names,
    pyramid_filters,
)
from .lattice import EXTENSIONS, Extension
from .nonsubsampled import NonsubsampledContourlet
from .operator import ContourletOperator, contourlet_operator
from .transform import Coefficients, Contourlet
from .wavelets import wavelet_band_names, wavelet_deviations

__version__ = "0.2.0"

__all__ = [
    "DIRECTIONAL_FILTERS",
    "EXTENSIONS",
    "Coefficients",
    "CoefficientsError",
    "Contourlet",
    "ContourletError",
    "ContourletOperator",
    "Extension",
    "ExtensionError",
    "FilterError",
    "ImageError",
    "LevelsError",
    "NonsubsampledContourlet",
    "band_deviations",
    "band_energies",
    "band_names",
    "contourlet_operator",
    "diamond_filters",
    "directional_deviations",
    "ladder_taps",
    "pyramid_filter_names",
    "pyramid_filters",
    "wavelet_band_names",
    "wavelet_deviations",
]
