"""Sequences that are shorter than those a model learns, from views that were touched less often.

One linear discriminant learns from bags of the training sequences' first touches, of several lengths at
once. Each length is standardised by itself, as what varies in a long sequence is constant in a short one,
and has its own temperatures and its own comparison with training objects.

Temperatures are fitted on the same held-out objects that answers are then compared with, not within the
folds as for whole sequences. A temperature is one number for all objects of a length and a number of
views, so this favours them little; the coverage that docs/recognition.md states was measured with it.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.arrays import Floats, Integers
from visuohaptic.recognition.certainty import (
    Calibration,
    bag_evidence,
    classify_bags,
    gather_calibration,
    landmarks_of,
    turn_bags,
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
from visuohaptic.recognition.splits import hold_out_objects
from visuohaptic.recognition.tuning import Projection, fit_projection

logger = logging.getLogger(__name__)

Described = Mapping[int, Floats]
"""Descriptors (n, d) of the same sequences by their first touches: so many, float64."""


@dataclass(frozen=True)
class ShortClassifier:
    """What classifies sequences of one length, c classes.

    `scaling`, `combination` and `calibration` are of this length, `projection` and `bags` of all
    lengths. `calibration` is None where no class has a second object.
    """

    scaling: Standardiser
    projection: Projection
    bags: BagClassifier
    classes: int
    combination: Combination
    calibration: Calibration | None = None

    @property
    def trained(self) -> Integers:
        """The classes that training had."""
        return self.bags.trained

    def encode(self, descriptors: Floats) -> Floats:
        """Project descriptors, (n, d) to (n, p)."""
        return self.projection.apply(self.scaling.apply(descriptors))

    def scores(self, projected: Floats) -> Floats:
        """Give a score a class, (n, p) to (n, c)."""
        return self.bags.scores(projected, self.classes)

    def ballots(self, projected: Floats) -> Ballots:
        """Give what is known of n sequences, (n, p), for one answer for any of them together."""
        return _ballots(self.scores(projected), self.combination)


def fit_short_classifiers(
    sequences: TouchSequences,
    described: Described,
    best: BestParameters,
    generator: np.random.Generator,
) -> dict[int, ShortClassifier]:
    """Fit a classifier for each length of `described`.

    `sequences` are the same training sequences with all their touches; the generator deals the
    objects over folds. Gives none without bags, or where no covariance can be taken of them.
    """
    if not described or not best.bags:
        return {}
    try:
        found = _fit(sequences, described, best)
        held_out = _name_held_out(sequences, described, best, generator)
    except RecognitionError as error:
        logger.warning("short sequences are classified as if they were whole: %s", error)
        return {}
    if not held_out.owners:
        return found
    touches = keep_touches(sequences, best.cues)
    for length, classifier in found.items():
        combination = _combine(sequences, held_out, length, classifier, best)
        rows = _calibration_rows(sequences, held_out, length, combination, best)
        projected = classifier.encode(described[length])
        marks = landmarks_of(projected, sequences.object_index, touches, best)
        calibration = gather_calibration(rows, marks, best)
        found[length] = replace(classifier, combination=combination, calibration=calibration)
    return found


@dataclass(frozen=True)
class _HeldOut:
    """What training objects score without themselves: (s, c) and, by object, (k, e) of each length."""

    owners: list[int]
    scores: dict[int, Floats]
    evidence: dict[int, dict[int, Floats]]


def _name_held_out(
    sequences: TouchSequences,
    described: Described,
    best: BestParameters,
    generator: np.random.Generator,
) -> _HeldOut:
    """Score every training object without itself; one whose class has no other is left out."""
    owners = sequences.object_index
    shape = (len(owners), len(sequences.classes))
    found = _HeldOut(
        [], {length: np.zeros(shape) for length in described}, {length: {} for length in described}
    )
    for train, objects in hold_out_objects(
        sequences.labels, owners, best.calibration_folds, generator
    ):
        found.owners.extend(objects)
        known = sequences.take(train)
        parts = {length: rows[train] for length, rows in described.items()}
        fits = _fit(known, parts, best)
        touches = keep_touches(known, best.cues)
        marks = {
            length: landmarks_of(fit.encode(parts[length]), known.object_index, touches, best)
            for length, fit in fits.items()
        }
        for place in objects:
            one = owners == place
            bags = turn_bags(int(one.sum()), place, best)
            distances = touches.distances(sequences.features[one])
            for length, classifier in fits.items():
                projected = classifier.encode(described[length][one])
                scores = found.scores[length][one] = classifier.scores(projected)
                found.evidence[length][place] = bag_evidence(
                    marks[length], projected, scores, bags, distances, length
                )
    found.owners.sort()
    return found


def _fit(
    sequences: TouchSequences, described: Described, best: BestParameters
) -> dict[int, ShortClassifier]:
    """Fit classifiers whose answers are not calibrated yet."""
    labels, owners = sequences.labels, sequences.object_index
    scalings = {length: fit_standardiser(rows, "standardise") for length, rows in described.items()}
    rows = np.concatenate([scalings[length].apply(rows) for length, rows in described.items()])
    projection = fit_projection(rows, best.bag_components)
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


def _combine(
    sequences: TouchSequences,
    held_out: _HeldOut,
    length: int,
    classifier: ShortClassifier,
    best: BestParameters,
) -> Combination:
    """Find the temperatures of one length by the objects that were held out."""
    kept = np.isin(sequences.object_index, held_out.owners)
    scores = held_out.scores[length][kept]
    known = classifier.combination.known
    owners = sequences.object_index[kept]
    alike = np.full(scores.shape, 1 / len(known))
    return fit_combination(alike, scores, sequences.labels[kept], owners, known, best)


def _calibration_rows(
    sequences: TouchSequences,
    held_out: _HeldOut,
    length: int,
    combination: Combination,
    best: BestParameters,
) -> list[tuple[int, Floats, Floats]]:
    """Give what `gather_calibration` takes, of one length."""
    rows, classes = [], sequences.class_of_object
    for place in held_out.owners:
        one = sequences.object_index == place
        label = int(classes[place])
        bags = turn_bags(int(one.sum()), place, best)
        probabilities = classify_bags(_ballots(held_out.scores[length][one], combination), bags)
        rows.append((label, 1 - probabilities[:, label], held_out.evidence[length][place]))
    return rows


def _ballots(scores: Floats, combination: Combination) -> Ballots:
    """Let the discriminant answer alone: beside it all classes are as likely."""
    return Ballots(np.full(scores.shape, 1 / scores.shape[1]), scores, combination)
