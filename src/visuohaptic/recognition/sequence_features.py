"""Compute statistics of sequences and of their wavelet levels."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.parameters import SequenceParameters

CONSTANT_TOLERANCE = 1e-12
"""A sequence whose standard deviation is at most this share of its rms counts as constant."""


def sequence_features(sequences: FloatArray, parameters: SequenceParameters) -> FloatArray:
    """Compute the statistics of sequences and of their wavelet levels: (s, t, m) to (s, m * (1 + levels) * 3).

    Columns are ordered by output of the map, then level, then statistic. The paper's settings give
    5 x (1 + 3) x 3 = 60 features. Raises `RecognitionError` if the wavelet is unknown.
    """
    along_time = np.moveaxis(sequences, 1, -1)
    levels = wavelet_levels(along_time, parameters)
    signals = [along_time, *(_without_rounding(level, along_time) for level in levels)]
    correction = 1 if parameters.degrees_of_freedom == "sample" else 0
    statistics = [summarise_signals(signal, correction) for signal in signals]
    return np.stack(statistics, axis=2).reshape(len(sequences), -1)


def wavelet_levels(signals: FloatArray, parameters: SequenceParameters) -> list[FloatArray]:
    """Decompose signals (..., t) along the last axis; return one array per level, the finest first.

    Raises `RecognitionError` if the wavelet is not one of PyWavelets' discrete ones.
    """
    import pywt

    try:
        wavelet = pywt.Wavelet(parameters.wavelet)
    except ValueError as error:
        raise RecognitionError(
            f"recognition.sequence.wavelet is {parameters.wavelet!r}; one of PyWavelets' discrete "
            f"wavelets is allowed, such as db2."
        ) from error
    kept = []
    approximation = signals
    for _ in range(parameters.levels):
        approximation, detail = pywt.dwt(approximation, wavelet, parameters.extension, axis=-1)
        kept.append(detail if parameters.bands == "details" else approximation)
    return kept


def _without_rounding(levels: FloatArray, signals: FloatArray) -> FloatArray:
    """Set the coefficients (..., k) of a level to 0 if all are rounding relative to their signal (..., t)."""
    # Details of a constant sequence are rounding; the skewness of rounding may be large.
    largest = np.abs(signals).max(axis=-1, keepdims=True)
    rounding = np.abs(levels).max(axis=-1, keepdims=True) <= CONSTANT_TOLERANCE * largest
    return np.where(rounding, 0.0, levels)


def summarise_signals(signals: FloatArray, correction: int) -> FloatArray:
    """Compute standard deviation, rms and skewness along the last axis: (..., t) to (..., 3), finite.

    The variance divides by t - correction, at least by 1. Skewness is m3 / m2 ** 1.5 with population moments, as in
    Matlab by default. A signal that is constant up to rounding has skewness 0.
    """
    length = signals.shape[-1]
    # Scaled to the largest value, so that powers neither overflow nor underflow.
    largest = np.abs(signals).max(axis=-1, keepdims=True)
    scaled = signals / np.where(largest > 0, largest, 1)
    deviations = scaled - scaled.mean(axis=-1, keepdims=True)
    second = np.square(deviations).mean(axis=-1)
    third = (deviations**3).mean(axis=-1)
    root_mean_square = np.sqrt(np.square(scaled).mean(axis=-1))
    constant = np.sqrt(second) <= CONSTANT_TOLERANCE * root_mean_square
    second = np.where(constant, 0, second)
    skewness = np.where(constant, 0, third / np.where(constant, 1, second) ** 1.5)
    deviation = np.sqrt(second * (length / max(length - correction, 1)))
    largest = largest[..., 0]
    return np.stack([deviation * largest, root_mean_square * largest, skewness], axis=-1)
