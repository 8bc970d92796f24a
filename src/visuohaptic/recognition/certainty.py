"""How sure an answer is: prediction sets at a stated coverage, and objects of no known class.

Both are cross-conformal in kind (V. Vovk, "Cross-conformal predictors", Annals of Mathematics and
Artificial Intelligence 74, 2015): an object is compared with training objects that were each classified
without themselves, by models of folds of whole objects. The object itself is classified by the final model,
which learnt from more; so the coverage is not guaranteed, and study `trust` measures it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.recognition.parameters import BestParameters, RecognitionParameters
from visuohaptic.recognition.pooling import Ballots, spread_bags
from visuohaptic.recognition.sequences import TouchSequences
from visuohaptic.recognition.set_distance import KnownTouches, keep_touches
from visuohaptic.recognition.splits import hold_out_objects
from visuohaptic.recognition.tuning import Projection, fit_best_classifiers


class SequenceClassifier(Protocol):
    """What classifies sequences: projected descriptors (n, p) become scores and ballots of c classes."""

    @property
    def trained(self) -> IntArray:
        """The classes that training had."""

    def scores(self, projected: FloatArray) -> FloatArray:
        """Give scores, shape (n, c)."""

    def ballots(self, projected: FloatArray) -> Ballots:
        """Give what is known of them, for one answer for any of them together."""


Described = Mapping[int, FloatArray]
"""Descriptors (n, d) of the same sequences by their first touches: so many."""

Fits = Mapping[int, tuple[Callable[[FloatArray], FloatArray], SequenceClassifier]]
"""What projects descriptors of so many touches, and what classifies them then."""


@dataclass(frozen=True)
class Landmarks:
    """Where the training objects lie: means (r, q) over their projected sequences, and touches."""

    objects: FloatArray
    touches: KnownTouches

    def evidence(self, projected: FloatArray, scores: FloatArray, nearest: float) -> FloatArray:
        """Give three signs that a bag is of no known class, shape (3,), larger the stranger.

        They are the distance of its sequences (n, p) from the nearest training object, the negative
        of the highest mean score of a class, of `scores` (n, c), and the distance of its touches
        from the nearest object's as sets, `nearest`.
        """
        seen = projected[:, : self.objects.shape[1]]
        distance = np.linalg.norm(self.objects - seen.mean(axis=0), axis=1).min()
        return np.array([distance, -scores.mean(axis=0).max(), nearest])


@dataclass(frozen=True)
class Certainty:
    """What an answer gives beside its probabilities.

    `candidates` (c,) is the prediction set; `strangeness` the share of known objects, this one
    counted among them, that are less strange by `evidence`; `unknown` says whether that is more
    than the stated share.
    """

    candidates: BoolArray
    strangeness: float
    unknown: bool
    evidence: float


@dataclass(frozen=True)
class Calibration:
    """Training objects, each predicted without itself, from bags of several sizes.

    `views` (k,) are the sequences in a bag, ascending, and `labels` (n,) the objects' classes.
    `nonconformity` (k, n) is 1 - probability of the true class, and `evidence` (k, n, e) what
    `Landmarks.evidence` gives. `landmarks` are of all, in the projection of the final fit.
    """

    views: IntArray
    labels: IntArray
    nonconformity: FloatArray
    evidence: FloatArray
    landmarks: Landmarks

    def assess(
        self,
        classifier: SequenceClassifier,
        projected: FloatArray,
        touches: FloatArray,
        probabilities: FloatArray,
        coverage: float,
    ) -> Certainty:
        """Compare a bag of sequences (n, p) and touches (m, k) with the training objects.

        `classifier` is the final fit, and `probabilities` (c,) are the answer for the bag.
        """
        size = self._size(len(projected))
        nearest = self.landmarks.touches.nearest(touches)
        evidence = self.landmarks.evidence(projected, classifier.scores(projected), nearest)
        strange = self.strangeness(size, evidence)
        rank = np.sum(self.strangeness(size, self.evidence[size]) >= strange)
        share = float((1 + rank) / (1 + len(self.labels)))
        candidates = self.prediction_set(
            probabilities, classifier.trained, len(projected), coverage
        )
        return Certainty(candidates, 1 - share, share <= _least_share(coverage), float(strange))

    def prediction_set(
        self, probabilities: FloatArray, trained: IntArray, sequences: int, coverage: float
    ) -> BoolArray:
        """Choose of the `trained` classes those whose p value is above 1 - coverage, (c,) to (c,)."""
        known = np.isin(np.arange(len(probabilities)), trained)
        p_values = self.p_values(self._size(sequences), 1 - probabilities, coverage)
        return known & (p_values > _least_share(coverage))

    def _size(self, sequences: int) -> int:
        """Give the place of the bags of as many sequences, or of the next smaller number."""
        return max(int(np.searchsorted(self.views, sequences, side="right")) - 1, 0)

    def strangeness(self, size: int, evidence: FloatArray) -> FloatArray:
        """Add all signs, (..., e), each divided by its deviation over the training objects."""
        spread = self.evidence[size].std(axis=0)
        return (evidence / np.where(spread > 0, spread, 1)).sum(axis=-1)

    def p_values(self, size: int, nonconformity: FloatArray, coverage: float) -> FloatArray:
        """Give the conformal p value of each class by its nonconformity, (c,) to (c,).

        It is the share of known objects, this one counted among them, that their class fits no
        better: of those of the class where they are enough for the coverage, else of all.
        """
        same = self.labels[:, None] == np.arange(len(nonconformity))
        compared = same | (same.sum(axis=0) < least_objects(coverage))
        no_better = compared & (self.nonconformity[size][:, None] >= nonconformity)
        return (1 + no_better.sum(axis=0)) / (1 + compared.sum(axis=0))


def least_objects(coverage: float) -> int:
    """Give with how many objects a set of this coverage can leave out a class at all."""
    return math.ceil(round(coverage / (1 - coverage), 9))


def _least_share(coverage: float) -> float:
    return 1 - coverage + 1e-12  # a rounding error apart


@dataclass(frozen=True)
class HeldOut:
    """A training object's sequences of one length, by what learnt from other objects.

    `places` are those of the sequences in one bag of each size, and `evidence` (k, e) is theirs.
    """

    place: int
    length: int
    ballots: Ballots
    places: Sequence[IntArray]
    evidence: FloatArray


def fit_calibration(
    sequences: TouchSequences,
    described: FloatArray,
    parameters: RecognitionParameters,
    projection: Projection,
    generator: np.random.Generator,
) -> Calibration | None:
    """Classify every training object whose class has another without itself; None if there is none.

    `described` (s, d) are the descriptors of the sequences, `parameters` those of one classifier of
    pipeline `best`, and `projection` is that of the final fit.
    """
    best, length = parameters.best, sequences.features.shape[1]

    def fit(known: TouchSequences, parts: Described) -> Fits:
        training = (parts[length], known.labels, known.object_index, len(known.classes))
        own, [(_, tuned, _)] = fit_best_classifiers(*training, parameters, generator)
        return {length: (own.apply, tuned)}

    held_out = hold_out(sequences, {length: described}, fit, best, generator)
    if not held_out:
        return None
    touches = keep_touches(sequences, best.cues)
    return calibrate(sequences, held_out, projection.apply(described), touches, best)


def hold_out(
    sequences: TouchSequences,
    described: Described,
    fit: Callable[[TouchSequences, Described], Fits],
    best: BestParameters,
    generator: np.random.Generator,
) -> list[HeldOut]:
    """Classify every training object whose class has another by folds that lack it, sorted by object.

    `fit` takes sequences and their descriptors; the generator deals the objects over the folds.
    """
    found, owners = [], sequences.object_index
    for train, objects in hold_out_objects(
        sequences.labels, owners, best.calibration_folds, generator
    ):
        known = sequences.take(train)
        parts = {length: rows[train] for length, rows in described.items()}
        fits, touches = fit(known, parts), keep_touches(known, best.cues)
        marks = {
            length: landmarks_of(encode(parts[length]), known.object_index, touches, best)
            for length, (encode, _) in fits.items()
        }
        for place in objects:
            one = owners == place
            bags = _turn_bags(int(one.sum()), place, best)
            distances = touches.distances(sequences.features[one])
            for length, (encode, classifier) in fits.items():
                projected = encode(described[length][one])
                scores = classifier.scores(projected)
                evidence = [
                    marks[length].evidence(
                        projected[bag], scores[bag], distances.nearest(np.s_[bag, :length])
                    )
                    for bag in bags
                ]
                ballots = classifier.ballots(projected)
                found.append(HeldOut(place, length, ballots, bags, np.array(evidence)))
    return sorted(found, key=lambda one: one.place)


def calibrate(
    sequences: TouchSequences,
    held_out: Sequence[HeldOut],
    projected: FloatArray,
    touches: KnownTouches,
    best: BestParameters,
) -> Calibration:
    """Gather training objects of one length; `projected` (n, p) are all sequences by the final fit."""
    labels = sequences.class_of_object[[one.place for one in held_out]]
    nonconformity = []
    for one, label in zip(held_out, labels, strict=True):
        places = np.arange(len(one.ballots.probabilities))
        answers = [one.ballots.together(np.isin(places, bag)[None])[0] for bag in one.places]
        nonconformity.append([1 - answer[label] for answer in answers])
    return Calibration(
        np.array(_bag_sizes(best), dtype=np.int64),
        labels,
        np.array(nonconformity).T,
        np.array([one.evidence for one in held_out]).transpose(1, 0, 2),
        landmarks_of(projected, sequences.object_index, touches, best),
    )


def landmarks_of(
    projected: FloatArray, owners: IntArray, touches: KnownTouches, best: BestParameters
) -> Landmarks:
    """Give landmarks by projected sequences (n, p) of objects (n,)."""
    seen = projected[:, : best.components]
    return Landmarks(spread_bags(owners, (len(owners),)).means(seen), touches)


def one_classifier(parameters: RecognitionParameters, classifier: str) -> RecognitionParameters:
    """Give parameters by which pipeline `best` fits one classifier alone."""
    best = parameters.best.model_copy(update={"classifiers": (classifier,)})
    return parameters.model_copy(update={"best": best})


def _bag_sizes(best: BestParameters) -> tuple[int, ...]:
    return tuple(sorted(best.bags)) or (1,)


def _turn_bags(sequences: int, turn: int, best: BestParameters) -> list[IntArray]:
    """Give places of one bag of each size among an object's sequences, by turns."""
    chosen = []
    for size in _bag_sizes(best):
        bags = spread_bags(np.zeros(sequences, dtype=np.int64), (size,))
        chosen.append(np.split(bags.places, np.cumsum(bags.counts)[:-1])[turn % len(bags.counts)])
    return chosen
