"""A sequence's statistics: of itself and of its wavelet levels."""

from __future__ import annotations

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.parameters import SequenceParameters

CONSTANT_TOLERANCE = 1e-12
"""A sequence whose standard deviation is at most this share of its rms counts as constant."""


def sequence_features(sequences: FloatArray, parameters: SequenceParameters) -> FloatArray:
    """Summarise sequences (s, t, m) by themselves and by the levels of their wavelet transform.

    Gives (s, m * (1 + levels) * 3) numbers, by output, then level, then statistic: with the paper's
    settings 5 x (1 + 3) x 3 = 60 features. Raises `RecognitionError` if the wavelet is unknown.
    """
    along_time = np.moveaxis(sequences, 1, -1)
    levels = wavelet_levels(along_time, parameters)
    signals = [along_time, *(_without_rounding(level, along_time) for level in levels)]
    correction = 1 if parameters.degrees_of_freedom == "sample" else 0
    statistics = [summarise_signals(signal, correction) for signal in signals]
    return np.stack(statistics, axis=2).reshape(len(sequences), -1)


def wavelet_levels(signals: FloatArray, parameters: SequenceParameters) -> list[FloatArray]:
    """Decompose signals (..., t) along their last axis, one array a level, the finest first.

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
    """Set a level's coefficients (..., k) to 0 where all are rounding beside their signal (..., t)."""
    # Details of a constant sequence are 0 but for rounding, whose skewness is as large as any.
    largest = np.abs(signals).max(axis=-1, keepdims=True)
    rounding = np.abs(levels).max(axis=-1, keepdims=True) <= CONSTANT_TOLERANCE * largest
    return np.where(rounding, 0.0, levels)


def summarise_signals(signals: FloatArray, correction: int) -> FloatArray:
    """Give standard deviation, rms and skewness along the last axis: (..., t) to (..., 3), finite.

    The standard deviation divides by t - correction (by t where t is 1). Skewness is m3 / m2 ** 1.5
    with population moments (Matlab's default), and 0 of a signal that is constant up to rounding.
    """
    length = signals.shape[-1]
    # Scaled to its largest value, no power over- or underflows.
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
