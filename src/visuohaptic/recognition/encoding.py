"""Encode sequences of touches by 60 features as the paper does: scaling, map, wavelet statistics, scaling."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from sklearn.base import BaseEstimator, TransformerMixin

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.maps import MAPS
from visuohaptic.recognition.parameters import RecognitionParameters, Scaling
from visuohaptic.recognition.sequence_features import sequence_features

ROUNDING = 1e-12
"""Relative size of rounding errors: some thousand times 2**-52, for the sums in a value."""

FEATURE_INPUT_SIZE = 1.0
"""Typical size of the inputs of touch features: imprints in [0, 1], unit normals, object radii."""


@dataclass(frozen=True)
class Standardiser:
    """Mean and scale (k,) of k columns. A constant column has an infinite scale, so that it becomes 0."""

    mean: FloatArray
    scale: FloatArray

    def apply(self, rows: FloatArray) -> FloatArray:
        """Subtract the mean and divide by the scale: (..., k) to (..., k)."""
        return (rows - self.mean) / self.scale

    def rounding_scale(self, rows: FloatArray) -> FloatArray:
        """Return the largest magnitude in the sum of `apply`, shape (..., k); rounding is some 1e-12 of the magnitude."""
        return (np.abs(rows) + np.abs(self.mean)) / self.scale


class SequenceEncoder(TransformerMixin, BaseEstimator):  # type: ignore[misc]
    """Encode sequences of touches as the paper does.

    Parameters
    ----------
    parameters : RecognitionParameters, optional
        Scalings, map and sequence statistics.
    random_state : numpy.random.Generator, optional
        Draws for maps that are trained in random order.

    Attributes
    ----------
    touch_scaling_, feature_scaling_ : Standardiser
        Scaling of the features of touches, and of the features of sequences.
    reduction_ : object
        The fitted map of `maps.MAPS`.
    """

    def __init__(
        self,
        parameters: RecognitionParameters | None = None,
        random_state: np.random.Generator | None = None,
    ) -> None:
        self.parameters = parameters
        self.random_state = random_state

    def fit(self, X: FloatArray, y: object = None) -> Self:  # noqa: ARG002 - scikit-learn's signature
        """Fit on training sequences (s, t, k).

        Raises `RecognitionError` if no feature varies over the touches, or if the map can't be fitted.
        """
        self._fit(X)
        return self

    def fit_transform(self, X: FloatArray, y: object = None) -> FloatArray:  # noqa: ARG002
        """Fit as `fit` does, and return the scaled features of the same sequences as `transform` does, computed once."""
        features = self._fit(X)
        return self.feature_scaling_.apply(features)

    def _fit(self, X: FloatArray) -> FloatArray:
        """Fit on sequences (s, t, k), and return their features before scaling."""
        touches = X.reshape(-1, X.shape[-1])
        if not np.ptp(touches, axis=0).any():
            raise RecognitionError(
                "Every feature has the same value at all training touches; at least one "
                "feature that varies is needed to distinguish classes."
            )
        parameters = self._parameters
        entry = MAPS[parameters.self_organising_map.output]
        generator = self.random_state or np.random.default_rng(0)
        self.touch_scaling_ = fit_standardiser(
            touches, parameters.touch_scaling, FEATURE_INPUT_SIZE
        )
        scaled = self.touch_scaling_.apply(touches)
        self.reduction_: Any = entry.fit(scaled, parameters.self_organising_map, generator)
        features = sequence_features(self.reduce(X), parameters.sequence)
        # A skewness has no unit, so that skewnesses near 0 are rounding. Deviation and rms have a unit.
        input_size = np.tile([0.0, 0.0, 1.0], features.shape[1] // 3)
        self.feature_scaling_ = fit_standardiser(features, parameters.sequence_scaling, input_size)
        return features

    def transform(self, X: FloatArray) -> FloatArray:
        """Compute the scaled features of sequences: (s, t, k) to (s, m * (1 + levels) * 3)."""
        features = sequence_features(self.reduce(X), self._parameters.sequence)
        return self.feature_scaling_.apply(features)

    def reduce(self, sequences: FloatArray) -> FloatArray:
        """Reduce each touch to m numbers: (s, t, k) to (s, t, m). Sequences that vary only by rounding become constant."""
        touches = sequences.reshape(-1, sequences.shape[-1])
        entry = MAPS[self._parameters.self_organising_map.output]
        reduced = entry.reduce(self.reduction_, self.touch_scaling_.apply(touches))
        reduced = reduced.reshape(*sequences.shape[:2], -1)
        if entry.rounding_scale is None:
            return reduced
        scale = entry.rounding_scale(self.reduction_, self.touch_scaling_.rounding_scale(touches))
        return _without_rounding(reduced, scale.reshape(reduced.shape))

    @property
    def _parameters(self) -> RecognitionParameters:
        return self.parameters or RecognitionParameters()


def fit_standardiser(
    rows: FloatArray, scaling: Scaling, input_size: float | FloatArray = 0.0
) -> Standardiser:
    """Fit the mean and standard deviation of columns, shape (n, k); scaling ``none`` changes nothing.

    A column counts as constant if its deviation is rounding noise relative to its largest value or to `input_size`, the
    typical size of the inputs from which the column was computed.
    """
    if scaling == "none":
        return Standardiser(np.zeros(rows.shape[1]), np.ones(rows.shape[1]))
    deviation = rows.std(axis=0)
    noise = ROUNDING * np.maximum(np.abs(rows).max(axis=0), input_size)
    return Standardiser(rows.mean(axis=0), np.where(deviation > noise, deviation, np.inf))


def _without_rounding(sequences: FloatArray, scale: FloatArray) -> FloatArray:
    """Replace sequences that vary only by rounding, at magnitude `scale`, by their mean; a mean that is rounding is 0."""
    noise = ROUNDING * scale.max(axis=1, keepdims=True)
    middle = sequences.mean(axis=1, keepdims=True)
    middle = np.where(np.abs(middle) > noise, middle, 0.0)
    constant = np.ptp(sequences, axis=1, keepdims=True) <= noise
    return np.where(constant, middle, sequences)
