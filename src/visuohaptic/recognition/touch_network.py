"""Pipeline `learned`: a perceptron of single touches or of pairs of touches, beside a discriminant of the sequence.

The perceptron learns the class of each touch, or of each ordered pair of touches. A sequence has the mean of the log
probabilities of its touches or pairs. So the order of touches does not matter, and copies of touches make no answer surer.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator, ClassifierMixin, TransformerMixin, clone
from sklearn.exceptions import ConvergenceWarning
from sklearn.preprocessing import StandardScaler

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.recognition.descriptors import (
    COORDINATES,
    describe_sequences,
    describe_touches,
    pose_of,
)
from visuohaptic.recognition.frames import WaveBasis, both_ways, pair_coordinates
from visuohaptic.recognition.parameters import Frame, RecognitionParameters

PAIR_WAVES = 128
"""Number of plane waves of a pair's distance and cosines."""

LOG_OFFSET = 0.01
"""Distance that is added before the logarithm of a pair's distance is computed (object radii)."""

MOST_ELEMENTS = 20
"""Most elements of a sequence that train; a longer sequence trains with a sample of its elements."""

LEAST_PROBABILITY = 1e-26
"""Probability of a class for which a classifier computes less."""


def touch_elements(
    features: FloatArray,
    names: Sequence[str],
    waves: WaveBasis,  # noqa: ARG001 - as all of `ELEMENTS`
    frame: Frame,
) -> FloatArray:
    """Compute what a frame knows of each touch's pose, and its imprint, size and contact: (s, t, k) to (s, t, e)."""
    points, normals = pose_of(features, names)
    return np.concatenate(
        [COORDINATES[frame](points, normals), describe_touches(features, names, frame)], axis=-1
    )


def pair_elements(
    features: FloatArray, names: Sequence[str], waves: WaveBasis, frame: Frame
) -> FloatArray:
    """Compute the relation of each ordered pair of touches, then both touches: (s, t, k) to (s, t (t - 1), e).

    The relation is the distance, its logarithm, the cosines of `frames.TouchPairs`, the size of the triple product of
    normals and connecting line, and `PAIR_WAVES` plane waves of distance and cosines. No rotation or translation changes
    the relation.
    """
    touches = touch_elements(features, names, waves, frame)
    points, normals = pose_of(features, names)
    pairs = both_ways(points, normals)
    across = np.cross(normals[:, pairs.first], normals[:, pairs.second])
    nothing = np.zeros_like(pairs.distance)
    coordinates = pair_coordinates(pairs, pairs.distance, nothing, nothing)
    relations = [
        pairs.distance,
        np.log(pairs.distance + LOG_OFFSET),
        pairs.leaving,
        pairs.arriving,
        pairs.agreement,
        np.abs((across * pairs.along).sum(axis=-1)),
    ]
    phases = coordinates @ waves.directions[:, :PAIR_WAVES] + waves.phases[:PAIR_WAVES]
    return np.concatenate(
        [
            np.stack(relations, axis=-1),
            np.cos(phases),
            touches[:, pairs.first],
            touches[:, pairs.second],
        ],
        axis=-1,
    )


ELEMENTS: Mapping[Frame, Callable[..., FloatArray]] = {
    "none": pair_elements,
    "centre": pair_elements,
    "vertical": touch_elements,
    "full": touch_elements,
}
"""Elements of sequences by the known part of the frame: pairs where a single touch has few coordinates."""


def learns_pairs(frame: Frame, touches: int | None) -> bool:
    """Return whether the elements of sequences of so many touches are pairs; a single touch has no pair.

    None, for all touches, counts as several.
    """
    return ELEMENTS[frame] is pair_elements and touches != 1


def learned_rows(
    features: FloatArray, names: Sequence[str], waves: WaveBasis, parameters: RecognitionParameters
) -> NDArray[np.void]:
    """Compute the input of `TouchNetwork` from sequences (s, t, k); `names` are those of the k columns.

    Returns
    -------
    ndarray of shape (s,)
        A structured array with the fields ``descriptors``, (d,) float64, by `describe_sequences`, and ``elements``, (n, e)
        float32, by `ELEMENTS`. A sequence of one touch has no pair: its element is the touch.

    Raises
    ------
    RecognitionError
        As `describe_sequences`.
    """
    descriptors = describe_sequences(features, names, waves, parameters)
    has_pairs = learns_pairs(parameters.frame, features.shape[1])
    compute = pair_elements if has_pairs else touch_elements
    elements = compute(features, names, waves, parameters.frame)
    return _as_rows(descriptors, elements)


class TouchPreparation(TransformerMixin, BaseEstimator):  # type: ignore[misc]
    """Scale and rotate the descriptors of `learned_rows`, and scale their elements.

    Parameters
    ----------
    descriptors : estimator
        Unfitted transformer of descriptors, (s, d).
    random_state : int or Generator, optional
        Draws the elements of long sequences by which elements are scaled.
    """

    def __init__(self, descriptors: Any, random_state: Any = None) -> None:
        self.descriptors = descriptors
        self.random_state = random_state

    def fit(self, rows: NDArray[np.void], labels: IntArray | None = None) -> Self:  # noqa: ARG002 - as scikit-learn
        """Fit on rows (s,) of `learned_rows`; `labels` have no influence."""
        self.descriptors_ = clone(self.descriptors).fit(rows["descriptors"])
        self.elements_ = StandardScaler().fit(_flat(_sample(rows["elements"], self.random_state)))
        return self

    def transform(self, rows: NDArray[np.void]) -> NDArray[np.void]:
        """Return prepared rows with the same fields: (s,) to (s,)."""
        elements = rows["elements"]
        scaled = self.elements_.transform(_flat(elements)).reshape(elements.shape)
        return _as_rows(self.descriptors_.transform(rows["descriptors"]), scaled)


class TouchNetwork(ClassifierMixin, BaseEstimator):  # type: ignore[misc]
    """Classifier of sequences by a network of their elements and a discriminant of their descriptors.

    Parameters
    ----------
    network : estimator
        Unfitted classifier of elements, (e,) each, with `predict_proba`.
    discriminant : estimator
        Unfitted classifier of descriptors, (d,) each, with `predict_proba`.
    discriminant_weight : float
        Weight of the discriminant's log probabilities beside the mean log probability of the elements.
    random_state : int, optional
        Seed of the network's fit.

    Attributes
    ----------
    classes_ : ndarray of shape (c,)
        Classes of the training sequences.
    """

    def __init__(
        self,
        network: Any,
        discriminant: Any,
        discriminant_weight: float = 0.1,
        random_state: int | None = None,
    ) -> None:
        self.network = network
        self.discriminant = discriminant
        self.discriminant_weight = discriminant_weight
        self.random_state = random_state

    def fit(self, rows: NDArray[np.void], labels: IntArray) -> Self:
        """Fit both classifiers on rows (s,) of `TouchPreparation` and their classes (s,)."""
        elements = _sample(rows["elements"], self.random_state)
        self.network_ = clone(self.network).set_params(random_state=self.random_state)
        with warnings.catch_warnings():
            # The number of passes is a setting; the network need not converge within it.
            warnings.simplefilter("ignore", ConvergenceWarning)
            self.network_.fit(_flat(elements), np.repeat(labels, elements.shape[1]))
        self.discriminant_ = clone(self.discriminant).fit(descriptors_of(rows), labels)
        self.classes_ = self.network_.classes_
        return self

    def predict_proba(self, rows: NDArray[np.void]) -> FloatArray:
        """Compute the probability of each class: (s,) to (s, c)."""
        elements = rows["elements"]
        by_element = _logs(self.network_, _flat(elements))
        logs = by_element.reshape(*elements.shape[:2], -1).mean(axis=1)
        logs = logs + self.discriminant_weight * _logs(self.discriminant_, descriptors_of(rows))
        probabilities: FloatArray = np.exp(logs - np.logaddexp.reduce(logs, axis=1, keepdims=True))
        return probabilities

    def predict(self, rows: NDArray[np.void]) -> IntArray:
        """Return the likeliest class of each sequence: (s,) to (s,)."""
        predicted: IntArray = self.classes_[self.predict_proba(rows).argmax(axis=1)]
        return predicted


def descriptors_of(prepared: Any) -> FloatArray:
    """Return the descriptors (s, d) of prepared rows: a field in pipeline `learned`, the rows themselves elsewhere."""
    descriptors: FloatArray = prepared["descriptors"] if prepared.dtype.names else prepared
    return np.ascontiguousarray(descriptors)


def _as_rows(descriptors: FloatArray, elements: FloatArray) -> NDArray[np.void]:
    fields = [
        ("descriptors", np.float64, descriptors.shape[1:]),
        ("elements", np.float32, elements.shape[1:]),
    ]
    rows = np.empty(len(descriptors), dtype=fields)
    rows["descriptors"], rows["elements"] = descriptors, elements
    return rows


def _sample(elements: FloatArray, seed: Any) -> FloatArray:
    """Return at most `MOST_ELEMENTS` elements of each sequence, without repetition: (s, n, e) to (s, m, e)."""
    sequences, count, _ = elements.shape
    if count <= MOST_ELEMENTS:
        return elements
    ranks = np.random.default_rng(seed).random((sequences, count)).argsort(axis=1)
    sampled: FloatArray = elements[np.arange(sequences)[:, None], ranks[:, :MOST_ELEMENTS]]
    return sampled


def _flat(elements: FloatArray) -> FloatArray:
    return elements.reshape(-1, elements.shape[-1])


def _logs(fitted: Any, rows: FloatArray) -> FloatArray:
    logs: FloatArray = np.log(np.maximum(fitted.predict_proba(rows), LEAST_PROBABILITY))
    return logs.astype(np.float64)
