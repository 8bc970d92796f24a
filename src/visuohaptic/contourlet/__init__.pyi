from .errors import CoefficientsError as CoefficientsError
from .errors import ContourletError as ContourletError
from .errors import ExtensionError as ExtensionError
from .errors import FilterError as FilterError
from .errors import ImageError as ImageError
from .errors import LevelsError as LevelsError
from .features import band_deviations as band_deviations
from .features import band_energies as band_energies
from .features import band_names as band_names
from .features import directional_deviations as directional_deviations
from .filters import DIRECTIONAL_FILTERS as DIRECTIONAL_FILTERS
from .filters import diamond_filters as diamond_filters
from .filters import ladder_taps as ladder_taps
from .filters import pyramid_filter_names as pyramid_filter_names
from .filters import pyramid_filters as pyramid_filters
from .lattice import EXTENSIONS as EXTENSIONS
from .lattice import Extension as Extension
from .nonsubsampled import NonsubsampledContourlet as NonsubsampledContourlet
from .operator import ContourletOperator as ContourletOperator
from .operator import contourlet_operator as contourlet_operator
from .transform import Coefficients as Coefficients
from .transform import Contourlet as Contourlet
from .transformer import ContourletDeviations as ContourletDeviations
from .transformer import WaveletDeviations as WaveletDeviations
from .wavelets import wavelet_band_names as wavelet_band_names
from .wavelets import wavelet_deviations as wavelet_deviations

__all__ = [
    "DIRECTIONAL_FILTERS",
    "EXTENSIONS",
    "Coefficients",
    "CoefficientsError",
    "Contourlet",
    "ContourletDeviations",
    "ContourletError",
    "ContourletOperator",
    "Extension",
    "ExtensionError",
    "FilterError",
    "ImageError",
    "LevelsError",
    "NonsubsampledContourlet",
    "WaveletDeviations",
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
