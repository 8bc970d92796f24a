"""The paper's way from touches to 60 features, fitted on training sequences alone."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.maps import MAPS
from visuohaptic.recognition.memory import FitMemory
from visuohaptic.recognition.parameters import (
    RecognitionParameters,
    Scaling,
    SelfOrganisingMapParameters,
    SequenceParameters,
)
from visuohaptic.recognition.sequence_features import sequence_features

ROUNDING = 1e-12
"""Share of a value that is rounding: 2**-52, some thousand times over for the sums behind it."""

FEATURES_MADE_OF = 1.0
"""Size of what features of touches are made of: imprints in [0, 1], unit normals, object radii."""


@dataclass(frozen=True)
class Standardiser:
    """Shift and scale of k columns; a column that was constant becomes 0, as its scale is infinite."""

    mean: FloatArray
    scale: FloatArray

    def apply(self, rows: FloatArray) -> FloatArray:
        """Standardise rows, shape (..., k)."""
        return (rows - self.mean) / self.scale

    def sizes(self, rows: FloatArray) -> FloatArray:
        """Give the size of what `apply` computes its numbers from."""
        return (np.abs(rows) + np.abs(self.mean)) / self.scale


@dataclass(frozen=True)
class SequenceEncoder:
    """What was fitted on the training sequences: touch scaling, map, feature scaling."""

    touch_scaling: Standardiser
    reduction: Any
    map_parameters: SelfOrganisingMapParameters
    sequence_parameters: SequenceParameters
    feature_scaling: Standardiser

    def encode(self, sequences: FloatArray) -> FloatArray:
        """Give the scaled features of sequences: (s, t, k) to (s, m * (1 + levels) * 3)."""
        reduced = self.reduce(sequences)
        return self.feature_scaling.apply(sequence_features(reduced, self.sequence_parameters))

    def reduce(self, sequences: FloatArray) -> FloatArray:
        """Reduce each touch to m numbers, (s, t, k) to (s, t, m), alike but for rounding to one."""
        touches = sequences.reshape(-1, sequences.shape[-1])
        scaled = self.touch_scaling.apply(touches)
        entry = MAPS[self.map_parameters.output]
        reduced = entry.reduce(self.reduction, scaled).reshape(*sequences.shape[:2], -1)
        if entry.sizes is None:
            return reduced
        sizes = entry.sizes(self.reduction, self.touch_scaling.sizes(touches))
        return _without_rounding(reduced, sizes.reshape(reduced.shape))


def fit_sequence_encoder(
    sequences: FloatArray,
    parameters: RecognitionParameters,
    generator: np.random.Generator,
    memory: FitMemory | None = None,
) -> SequenceEncoder:
    """Fit touch scaling, map and feature scaling on training sequences (s, t, k).

    `memory` holds maps of other calls and changes no number. Raises `RecognitionError` if no
    feature varies over the touches, or a setting does not fit.
    """
    touches = sequences.reshape(-1, sequences.shape[-1])
    if not np.ptp(touches, axis=0).any():
        raise RecognitionError(
            "Every feature has one and the same value at all training touches; "
            "the classes can't be distinguished."
        )
    settings = parameters.self_organising_map
    entry, draws = MAPS[settings.output], generator.bit_generator

    def fit_map() -> tuple[Standardiser, Any, Any]:
        scaling = fit_standardiser(touches, parameters.touch_scaling, FEATURES_MADE_OF)
        return scaling, entry.fit(scaling.apply(touches), settings, generator), draws.state

    # Outputs may read the same map, each in its own way.
    fitted_as = settings.model_copy(update={"output": entry.fitted_as or entry.name})
    known = (touches, parameters.touch_scaling, fitted_as, draws.state)
    # A remembered map leaves the generator as fitting it would.
    scaling, reduction, draws.state = (memory or FitMemory(1)).recall(known, fit_map)
    unscaled = SequenceEncoder(scaling, reduction, settings, parameters.sequence, _identity(1))
    encoded = unscaled.encode(sequences)
    # A skewness has no unit, so a column of skewnesses near 0 is rounding; deviation and rms have one.
    made_of = np.tile([0.0, 0.0, 1.0], encoded.shape[1] // 3)
    feature_scaling = fit_standardiser(encoded, parameters.sequence_scaling, made_of)
    return replace(unscaled, feature_scaling=feature_scaling)


def fit_standardiser(
    rows: FloatArray, scaling: Scaling, made_of: float | FloatArray = 0.0
) -> Standardiser:
    """Fit the mean and standard deviation of columns, shape (n, k); `none` leaves all as it is.

    A column is constant, and 0 from then on, when its deviation is rounding noise beside its largest
    value, or beside `made_of`, the size of what columns are computed from.
    """
    if scaling == "none":
        return _identity(rows.shape[1])
    deviation = rows.std(axis=0)
    noise = ROUNDING * np.maximum(np.abs(rows).max(axis=0), made_of)
    return Standardiser(rows.mean(axis=0), np.where(deviation > noise, deviation, np.inf))


def _identity(columns: int) -> Standardiser:
    return Standardiser(np.zeros(columns), np.ones(columns))


def _without_rounding(sequences: FloatArray, sizes: FloatArray) -> FloatArray:
    """Give sequences that are constant but for rounding one value, 0 if that is rounding of `sizes`."""
    noise = ROUNDING * sizes.max(axis=1, keepdims=True)
    middle = sequences.mean(axis=1, keepdims=True)
    middle = np.where(np.abs(middle) > noise, middle, 0.0)
    constant = np.ptp(sequences, axis=1, keepdims=True) <= noise
    return np.where(constant, middle, sequences)
