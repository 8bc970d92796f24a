"""How sure an answer is: prediction sets at a stated coverage, and objects of no known class.

Both are conformal (V. Vovk, A. Gammerman, G. Shafer, "Algorithmic learning in a random world", 2005):
an object is compared with training objects that were each named without themselves, by folds of whole
objects.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from visuohaptic.recognition.parameters import BestParameters, RecognitionParameters
from visuohaptic.recognition.pooling import spread_bags
from visuohaptic.recognition.set_distance import KnownTouches, keep_touches
from visuohaptic.recognition.splits import grouped_folds
from visuohaptic.recognition.tuning import (
    Projection,
    TunedClassifier,
    class_scores,
    fit_best_classifiers,
)


@dataclass(frozen=True)
class Landmarks:
    """Where the training objects lie.

    Attributes
    ----------
    objects : numpy.ndarray
        Shape (r, q), float64: the mean over each training object's sequences, among the projected
        descriptors.
    touches : KnownTouches or None
        Their touches; None in models of the second format.
    """

    objects: NDArray[np.float64]
    touches: KnownTouches | None

    def evidence(
        self,
        tuned: TunedClassifier,
        projected: NDArray[np.float64],
        touches: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """Give three signs that a bag is of no known class, shape (3,), larger the stranger.

        `projected` are its sequences, shape (n, p), and `touches` its touches, shape (m, k), float64. The
        signs are the distance from the nearest training object, the negative of the highest mean score
        of a class, and, where touches were kept, their distance from the nearest object's as sets.
        """
        seen = projected[:, : self.objects.shape[1]]
        distance = np.linalg.norm(self.objects - seen.mean(axis=0), axis=1).min()
        scores = class_scores(tuned.estimator, seen, tuned.classes)
        signs = [distance, -scores.mean(axis=0).max()]
        if self.touches is not None:
            signs.append(self.touches.nearest(touches))
        return np.array(signs)


@dataclass(frozen=True)
class Certainty:
    """What an answer gives beside its probabilities.

    Attributes
    ----------
    candidates : numpy.ndarray
        Shape (c,), bool: the prediction set. It holds the class of an object of a known class in the
        stated share of cases; it may be empty.
    fits : numpy.ndarray
        Shape (c,), float64: how well each class fits, the conformal p value: the share of known objects,
        this one counted among them, that their class fits no better. 0 for a class that training lacked.
        It is in a set of any coverage above 1 - its fit.
    strangeness : float
        Between 0 and 1: the share of known objects, this one counted among them, that are no stranger
        than it.
    unknown : bool
        Whether the object is stranger than the stated share of the known ones.
    evidence : float
        By which objects are compared: larger is stranger.
    """

    candidates: NDArray[np.bool_]
    fits: NDArray[np.float64]
    strangeness: float
    unknown: bool
    evidence: float


@dataclass(frozen=True)
class Calibration:
    """Training objects, each named without itself, from bags of several sizes.

    Attributes
    ----------
    views : numpy.ndarray
        Shape (k,), int64: sequences in a bag, ascending.
    labels : numpy.ndarray
        Shape (n,), int64: the objects' classes.
    misfits : numpy.ndarray
        Shape (k, n), float64: 1 - probability of the true class.
    evidence : numpy.ndarray
        Shape (k, n, e), float64: as `Landmarks.evidence` gives it.
    landmarks : Landmarks
        Of all training objects, in the projection of the final fit.
    """

    views: NDArray[np.int64]
    labels: NDArray[np.int64]
    misfits: NDArray[np.float64]
    evidence: NDArray[np.float64]
    landmarks: Landmarks

    def assess(
        self,
        tuned: TunedClassifier,
        projected: NDArray[np.float64],
        touches: NDArray[np.float64],
        probabilities: NDArray[np.float64],
        coverage: float,
    ) -> Certainty:
        """Compare a bag with the training objects.

        Parameters
        ----------
        tuned : TunedClassifier
            The final fit.
        projected : numpy.ndarray
            Shape (n, p), float64: the bag's sequences.
        touches : numpy.ndarray
            Shape (m, k), float64: all its touches.
        probabilities : numpy.ndarray
            Shape (c,), float64: the answer for the bag.
        coverage : float
            The stated share.

        Returns
        -------
        Certainty
            By bags of as many sequences, or of the next smaller number.
        """
        size = max(int(np.searchsorted(self.views, len(projected), side="right")) - 1, 0)
        strange = self.strangeness(size, self.landmarks.evidence(tuned, projected, touches))
        rank = np.sum(self.strangeness(size, self.evidence[size]) >= strange)
        share = float((1 + rank) / (1 + len(self.labels)))
        known = np.isin(np.arange(len(probabilities)), tuned.estimator.classes_)
        fits = np.where(known, self.fits(size, 1 - probabilities, coverage), 0.0)
        least = 1 - coverage + 1e-12
        return Certainty(fits > least, fits, 1 - share, share <= least, float(strange))

    def strangeness(self, size: int, evidence: NDArray[np.float64]) -> NDArray[np.float64]:
        """Add all signs, (..., e), each divided by its deviation over the training objects."""
        spread = self.evidence[size].std(axis=0)
        added: NDArray[np.float64] = (evidence / np.where(spread > 0, spread, 1)).sum(axis=-1)
        return added

    def fits(self, size: int, misfits: NDArray[np.float64], coverage: float) -> NDArray[np.float64]:
        """Give how well each class fits by its misfit, shape (c,), as in `Certainty.fits`.

        A class with enough objects of its own for the coverage is compared with these, so that the
        coverage holds within it; the others are compared with all objects.
        """
        same = self.labels[:, None] == np.arange(len(misfits))
        compared = same | (same.sum(axis=0) < least_objects(coverage))
        no_better = compared & (self.misfits[size][:, None] >= misfits)
        shares: NDArray[np.float64] = (1 + no_better.sum(axis=0)) / (1 + compared.sum(axis=0))
        return shares


def least_objects(coverage: float) -> int:
    """Give with how many objects a set of this coverage can leave out a class at all."""
    return math.ceil(round(coverage / (1 - coverage), 9))


def fit_calibration(
    descriptors: NDArray[np.float64],
    touches: NDArray[np.float64],
    names: Sequence[str],
    labels: NDArray[np.int64],
    owners: NDArray[np.int64],
    classes: int,
    parameters: RecognitionParameters,
    projection: Projection,
    generator: np.random.Generator,
) -> Calibration | None:
    """Name every training object without itself, from bags of each size.

    Parameters
    ----------
    descriptors : numpy.ndarray
        Shape (n, d), float64: the training sequences.
    touches : numpy.ndarray
        Shape (n, t, k), float64: their touches.
    names : sequence of str
        The k features of a touch.
    labels, owners : numpy.ndarray
        Shape (n,), int64: their classes and objects.
    classes : int
        Number of classes.
    parameters : RecognitionParameters
        Of one classifier of pipeline `best`.
    projection : Projection
        Of the final fit.
    generator : numpy.random.Generator
        Deals the objects over folds.

    Returns
    -------
    Calibration or None
        None where no class has a second object. An object whose class has no other is left out.
    """
    best = parameters.best
    members = [np.unique(owners[labels == place]).tolist() for place in np.unique(labels)]
    if max(len(objects) for objects in members) < 2:
        return None
    rows: dict[int, tuple[int, list[float], list[NDArray[np.float64]]]] = {}
    for objects in grouped_folds(members, best.calibration_folds, generator):
        held_out = np.isin(owners, objects)
        if len(np.unique(labels[~held_out])) < 2:
            continue
        own, fits = fit_best_classifiers(
            descriptors[~held_out],
            labels[~held_out],
            owners[~held_out],
            classes,
            parameters,
            generator,
        )
        tuned = fits[0][1]
        learnt = touches[~held_out]
        marks = find_landmarks(
            own.apply(descriptors[~held_out]), learnt, names, owners[~held_out], best
        )
        for place in objects:
            one = owners == place
            label = int(labels[one][0])
            if label in labels[~held_out]:
                named = _name_bags(
                    tuned, marks, own.apply(descriptors[one]), touches[one], place, best
                )
                rows[place] = (
                    label,
                    [1 - found[label] for found, _ in named],
                    [e for _, e in named],
                )
    if not rows:
        return None
    found = [rows[place] for place in sorted(rows)]
    return Calibration(
        np.array(_sizes(best), dtype=np.int64),
        np.array([label for label, _, _ in found], dtype=np.int64),
        np.array([misfits for _, misfits, _ in found]).T,
        np.array([evidence for _, _, evidence in found]).transpose(1, 0, 2),
        find_landmarks(projection.apply(descriptors), touches, names, owners, best),
    )


def find_landmarks(
    projected: NDArray[np.float64],
    touches: NDArray[np.float64],
    names: Sequence[str],
    owners: NDArray[np.int64],
    best: BestParameters,
) -> Landmarks:
    """Keep touches (n, t, k), and means over each object's sequences (n, p), of the components that classifiers see."""
    whole = spread_bags(owners, (len(owners),))
    return Landmarks(
        whole.means(projected[:, : best.components]),
        keep_touches(touches, names, owners, best.cues),
    )


def one_classifier(parameters: RecognitionParameters, classifier: str) -> RecognitionParameters:
    """Give parameters by which pipeline `best` fits one classifier alone."""
    best = parameters.best.model_copy(update={"classifiers": (classifier,)})
    return parameters.model_copy(update={"best": best})


def _sizes(best: BestParameters) -> tuple[int, ...]:
    return tuple(sorted(best.bags)) or (1,)


def _name_bags(
    tuned: TunedClassifier,
    marks: Landmarks,
    projected: NDArray[np.float64],
    touches: NDArray[np.float64],
    turn: int,
    best: BestParameters,
) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Give the answer for one bag of each size of an object, and its evidence.

    Which of its bags of a size it is takes turns with the object's number.
    """
    ballots = tuned.ballots(projected)
    named = []
    for size in _sizes(best):
        bags = spread_bags(np.zeros(len(projected), dtype=np.int64), (size,))
        bag = np.split(bags.places, np.cumsum(bags.counts)[:-1])[turn % len(bags.counts)]
        member = np.isin(np.arange(len(projected)), bag)
        found = ballots.together(member[None])[0]
        felt = touches[bag].reshape(-1, touches.shape[2])
        named.append((found, marks.evidence(tuned, projected[bag], felt)))
    return named
