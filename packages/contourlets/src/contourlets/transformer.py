"""Band features as scikit-learn transformers; only this module needs scikit-learn."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, TransformerMixin
from sklearn.utils.validation import check_is_fitted

from .errors import ImageError
from .features import band_deviations, band_energies, band_names
from .images import Array, FloatArray, check_stack
from .lattice import Extension
from .transform import Contourlet
from .wavelets import wavelet_band_names, wavelet_deviations


class _BandFeatures(TransformerMixin, BaseEstimator, ABC):  # type: ignore[misc]
    """Base class of transformers of images (n, rows, columns), float32 or float64."""

    def fit(self, X: ArrayLike, y: object = None) -> Self:  # noqa: ARG002 (scikit-learn's signature)
        """Store the size of the images and check parameters on the first image; raises `ContourletError`."""
        images = check_stack(X)
        self._features(images[:1])
        self.image_shape_ = images.shape[1:]
        self.n_features_in_ = images.shape[1] * images.shape[2]
        return self

    def transform(self, X: ArrayLike) -> Array:
        """Compute the features (n, features), float64, of images of the fitted size."""
        check_is_fitted(self, "image_shape_")
        images = check_stack(X)
        if images.shape[1:] != self.image_shape_:
            rows, columns = self.image_shape_
            raise ImageError(
                f"This transformer was fitted to images of {rows} × {columns} and can't transform images of "
                f"{images.shape[1]} × {images.shape[2]}."
            )
        return self._features(images)

    def get_feature_names_out(self, input_features: object = None) -> NDArray[Any]:  # noqa: ARG002
        """Return the names of the features."""
        return np.asarray(self._names(), dtype=object)

    @abstractmethod
    def _features(self, images: FloatArray) -> Array:
        """Compute the features of checked images, shape (n, features)."""

    @abstractmethod
    def _names(self) -> list[str]:
        """Return the names of the features, in their order."""


class ContourletDeviations(_BandFeatures):
    """Standard deviations, or energies, of the directional bands of a contourlet transform.

    Parameters
    ----------
    levels : tuple of int
        l of every pyramid level, the coarsest first.
    pyramid_filter, directional_filter, extension : str
        See `Contourlet`.
    statistic : {"deviation", "energy"}
        Standard deviation with N − 1, or the sum of squares.

    Examples
    --------
    >>> import numpy as np
    >>> images = np.random.default_rng(0).random((5, 32, 32))
    >>> transformer = ContourletDeviations(levels=(4,)).fit(images)
    >>> transformer.transform(images).shape
    (5, 16)
    >>> transformer.get_feature_names_out()[0]
    'level1_band01_deviation'
    """

    def __init__(
        self,
        levels: tuple[int, ...] = (4,),
        pyramid_filter: str = "9-7",
        directional_filter: str = "pkva",
        extension: Extension = "periodic",
        statistic: Literal["deviation", "energy"] = "deviation",
    ) -> None:
        self.levels = levels
        self.pyramid_filter = pyramid_filter
        self.directional_filter = directional_filter
        self.extension = extension
        self.statistic = statistic

    def _contourlet(self) -> Contourlet:
        return Contourlet(self.levels, self.pyramid_filter, self.directional_filter, self.extension)

    def _features(self, images: FloatArray) -> Array:
        statistics = {"deviation": band_deviations, "energy": band_energies}
        if self.statistic not in statistics:
            raise ImageError(
                f"The statistic of a band is deviation or energy, not {self.statistic!r}."
            )
        return statistics[self.statistic](images, self._contourlet())

    def _names(self) -> list[str]:
        return [f"{name}_{self.statistic}" for name in band_names(self._contourlet())]


class WaveletDeviations(_BandFeatures):
    """Standard deviations (N − 1) of the detail bands of a wavelet transform.

    Parameters
    ----------
    wavelet : str
        A discrete wavelet of PyWavelets, such as `db2` or `bior4.4`.
    levels : int
    mode : str
        Border extension of PyWavelets.
    """

    def __init__(
        self,
        wavelet: str = "db2",
        levels: int = 3,
        mode: str = "periodization",
    ) -> None:
        self.wavelet = wavelet
        self.levels = levels
        self.mode = mode

    def _features(self, images: FloatArray) -> Array:
        return wavelet_deviations(images, self.wavelet, self.levels, self.mode)

    def _names(self) -> list[str]:
        return [f"{name}_deviation" for name in wavelet_band_names(self.levels)]
