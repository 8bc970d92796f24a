"""Sequences that are shorter than those a model learns, from views that were touched less often.

One linear discriminant learns from bags of the training sequences' first touches, of several lengths at
once. Each length is standardised by itself, as what varies in a long sequence is constant in a short one,
and has its own temperatures and its own comparison with training objects. Temperatures are fitted on the
same held-out objects that answers are then compared with, not within the folds as for whole sequences.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace

import numpy as np

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.recognition.certainty import (
    Calibration,
    Described,
    Fits,
    calibrate,
    hold_out,
)
from visuohaptic.recognition.encoding import Standardiser, fit_standardiser
from visuohaptic.recognition.parameters import BestParameters
from visuohaptic.recognition.pooling import (
    BagClassifier,
    Ballots,
    Combination,
    fit_bag_classifier,
    fit_combination,
)
from visuohaptic.recognition.sequences import TouchSequences
from visuohaptic.recognition.set_distance import keep_touches
from visuohaptic.recognition.tuning import BAG_COMPONENTS, Projection, fit_projection

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class ShortClassifier:
    """What classifies sequences of one length; `projection` and `bags` are of all lengths."""

    scaling: Standardiser
    projection: Projection
    bags: BagClassifier
    classes: int
    combination: Combination
    calibration: Calibration | None = None

    @property
    def trained(self) -> IntArray:
        """The classes that training had."""
        return self.bags.trained

    def encode(self, descriptors: FloatArray) -> FloatArray:
        """Project descriptors, (n, d) to (n, p)."""
        return self.projection.apply(self.scaling.apply(descriptors))

    def scores(self, projected: FloatArray) -> FloatArray:
        """Give a score a class, (n, p) to (n, c)."""
        return self.bags.scores(projected, self.classes)

    def ballots(self, projected: FloatArray) -> Ballots:
        """Give what is known of n sequences, (n, p), for one answer for any of them together."""
        scores = self.scores(projected)
        # The discriminant answers alone: beside it all classes are as likely.
        return Ballots(np.full(scores.shape, 1 / self.classes), scores, self.combination)


def fit_short_classifiers(
    sequences: TouchSequences,
    described: Described,
    best: BestParameters,
    generator: np.random.Generator,
) -> dict[int, ShortClassifier]:
    """Fit a classifier for each length of `described`, which `sequences` have with all their touches.

    Gives none without bags, or where no covariance can be taken of them.
    """
    if not described or not best.bags:
        return {}

    def fit(known: TouchSequences, parts: Described) -> Fits:
        fits = _fit(known, parts, best)
        return {length: (classifier.encode, classifier) for length, classifier in fits.items()}

    try:
        found = _fit(sequences, described, best)
        held_out = hold_out(sequences, described, fit, best, generator)
    except RecognitionError as error:
        logger.warning("short sequences are classified as if they were whole: %s", error)
        return {}
    if not held_out:
        return found
    touches = keep_touches(sequences, best.cues)
    for length, classifier in found.items():
        own = [one for one in held_out if one.length == length]
        ballots = [one.ballots for one in own]
        owners = np.repeat([one.place for one in own], [len(one.probabilities) for one in ballots])
        combination = fit_combination(
            np.concatenate([one.probabilities for one in ballots]),
            np.concatenate([one.scores for one in ballots]),
            sequences.class_of_object[owners],
            owners,
            classifier.combination.known,
            best,
        )
        own = [replace(one, ballots=replace(one.ballots, combination=combination)) for one in own]
        projected = classifier.encode(described[length])
        calibration = calibrate(sequences, own, projected, touches, best)
        found[length] = replace(classifier, combination=combination, calibration=calibration)
    return found


def _fit(
    sequences: TouchSequences, described: Described, best: BestParameters
) -> dict[int, ShortClassifier]:
    """Fit classifiers whose answers are not calibrated yet."""
    labels, owners = sequences.labels, sequences.object_index
    scalings = {length: fit_standardiser(rows, "standardise") for length, rows in described.items()}
    rows = np.concatenate([scalings[length].apply(rows) for length, rows in described.items()])
    projection = fit_projection(rows, BAG_COMPONENTS)
    apart = np.arange(len(described))[:, None] * (owners.max() + 1)  # no bag holds two lengths
    bags = fit_bag_classifier(
        projection.apply(rows),
        np.tile(labels, len(described)),
        (owners + apart).ravel(),
        best.bags,
    )
    classes = len(sequences.classes)
    known = np.isin(np.arange(classes), labels)
    alike = Combination((1.0, 1.0), np.ones(1), np.ones(1), known)
    return {
        length: ShortClassifier(scaling, projection, bags, classes, alike)
        for length, scaling in scalings.items()
    }
