"""How sure an answer is: prediction sets at a stated coverage, and objects of no known class.

Both are cross-conformal in kind (V. Vovk, "Cross-conformal predictors", Annals of Mathematics and
Artificial Intelligence 74, 2015): an object is compared with training objects that were each classified
without themselves, by models of folds of whole objects. The object itself is classified by the final model,
which learnt from more; so the coverage is not guaranteed, and `studies.certainty` measures it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from visuohaptic.recognition.arrays import Flags, Floats, Integers
from visuohaptic.recognition.parameters import BestParameters, RecognitionParameters
from visuohaptic.recognition.pooling import Ballots, spread_bags
from visuohaptic.recognition.sequences import TouchSequences
from visuohaptic.recognition.set_distance import KnownTouches, TouchDistances, keep_touches
from visuohaptic.recognition.splits import hold_out_objects
from visuohaptic.recognition.tuning import Projection, fit_best_classifiers


class SequenceClassifier(Protocol):
    """What classifies sequences: projected descriptors (n, p) become scores and ballots of c classes."""

    @property
    def trained(self) -> Integers:
        """The classes that training had."""

    def scores(self, projected: Floats) -> Floats:
        """Give scores, shape (n, c)."""

    def ballots(self, projected: Floats) -> Ballots:
        """Give what is known of them, for one answer for any of them together."""


@dataclass(frozen=True)
class Landmarks:
    """Where the training objects lie.

    `objects` (r, q) are the means over each object's sequences, among the projected descriptors.
    """

    objects: Floats
    touches: KnownTouches

    def evidence(self, projected: Floats, scores: Floats, nearest: float) -> Floats:
        """Give three signs that a bag is of no known class, shape (3,), larger the stranger.

        `projected` are its sequences, shape (n, p), and `scores` what they score, shape (n, c). The
        signs are the distance from the nearest training object, the negative of the highest mean
        score of a class, and the distance of its touches from the nearest object's as sets,
        `nearest`.
        """
        seen = projected[:, : self.objects.shape[1]]
        distance = np.linalg.norm(self.objects - seen.mean(axis=0), axis=1).min()
        return np.array([distance, -scores.mean(axis=0).max(), nearest])


@dataclass(frozen=True)
class Certainty:
    """What an answer gives beside its probabilities.

    `candidates` (c,) is the prediction set, which is made to hold the class of an object of a known
    class in the stated share of cases; it may be empty. `strangeness`, 0 to 1, is the share of
    known objects, this one counted among them, that are no stranger than it; `unknown` says whether
    it is stranger than the stated share of them. Objects are compared by `evidence`: larger is
    stranger.
    """

    candidates: Flags
    strangeness: float
    unknown: bool
    evidence: float


@dataclass(frozen=True)
class Calibration:
    """Training objects, each predicted without itself, from bags of several sizes.

    `views` (k,) are the sequences in a bag, ascending, and `labels` (n,) the objects' classes.
    `nonconformity` (k, n) is 1 - probability of the true class, and `evidence` (k, n, e) what
    `Landmarks.evidence` gives. `landmarks` are of all training objects, in the projection of the
    final fit.
    """

    views: Integers
    labels: Integers
    nonconformity: Floats
    evidence: Floats
    landmarks: Landmarks

    def assess(
        self,
        classifier: SequenceClassifier,
        projected: Floats,
        touches: Floats,
        probabilities: Floats,
        coverage: float,
    ) -> Certainty:
        """Compare a bag with the training objects.

        Their bags are of as many sequences, or of the next smaller number. `classifier` is the
        final fit, `projected` (n, p) are the bag's sequences, `touches` (m, k) all its touches, and
        `probabilities` (c,) the answer for it; `coverage` is the stated share.
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
        self, probabilities: Floats, trained: Integers, sequences: int, coverage: float
    ) -> Flags:
        """Choose the classes whose p value is above 1 - coverage, shape (c,), of those that training had.

        `probabilities` are the answer for a bag of so many sequences, shape (c,).
        """
        known = np.isin(np.arange(len(probabilities)), trained)
        p_values = self.p_values(self._size(sequences), 1 - probabilities, coverage)
        return known & (p_values > _least_share(coverage))

    def _size(self, sequences: int) -> int:
        """Give the place of the bags to compare with: of as many sequences, or the next smaller number."""
        return max(int(np.searchsorted(self.views, sequences, side="right")) - 1, 0)

    def strangeness(self, size: int, evidence: Floats) -> Floats:
        """Add all signs, (..., e), each divided by its deviation over the training objects."""
        spread = self.evidence[size].std(axis=0)
        return (evidence / np.where(spread > 0, spread, 1)).sum(axis=-1)

    def p_values(self, size: int, nonconformity: Floats, coverage: float) -> Floats:
        """Give the conformal p value of each class by its nonconformity, (c,) to (c,).

        It is the share of known objects, this one counted among them, that their class fits no
        better. A class with enough objects of its own for the coverage is compared with these, so
        that the coverage is that of its own objects; the others are compared with all.
        """
        same = self.labels[:, None] == np.arange(len(nonconformity))
        compared = same | (same.sum(axis=0) < least_objects(coverage))
        no_better = compared & (self.nonconformity[size][:, None] >= nonconformity)
        return (1 + no_better.sum(axis=0)) / (1 + compared.sum(axis=0))


def least_objects(coverage: float) -> int:
    """Give with how many objects a set of this coverage can leave out a class at all."""
    return math.ceil(round(coverage / (1 - coverage), 9))


def _least_share(coverage: float) -> float:
    """Give the share above which a class or an object is like the known ones, a rounding error apart."""
    return 1 - coverage + 1e-12


def fit_calibration(
    sequences: TouchSequences,
    described: Floats,
    parameters: RecognitionParameters,
    projection: Projection,
    generator: np.random.Generator,
) -> Calibration | None:
    """Classify every training object without itself, from bags of each size.

    `described` (s, d) are the descriptors of the sequences, `parameters` those of one classifier of
    pipeline `best`, and `projection` is that of the final fit; the generator deals the objects over
    folds. An object whose class has no other is left out; gives None where no class has a second
    one.
    """
    best, labels = parameters.best, sequences.labels
    rows: dict[int, tuple[int, Floats, Floats]] = {}
    for train, objects in hold_out_objects(
        labels, sequences.object_index, best.calibration_folds, generator
    ):
        known = sequences.take(train)
        training = (described[train], known.labels, known.object_index, len(known.classes))
        own, [(_, tuned, _)] = fit_best_classifiers(*training, parameters, generator)
        touches = keep_touches(known, best.cues)
        marks = landmarks_of(own.apply(described[train]), known.object_index, touches, best)
        for place in objects:
            one = sequences.object_index == place
            label = int(labels[one][0])
            projected = own.apply(described[one])
            bags = turn_bags(len(projected), place, best)
            probabilities = classify_bags(tuned.ballots(projected), bags)
            scores = tuned.scores(projected)
            distances = touches.distances(sequences.features[one])
            found = bag_evidence(marks, projected, scores, bags, distances)
            rows[place] = (label, 1 - probabilities[:, label], found)
    if not rows:
        return None
    touches = keep_touches(sequences, best.cues)
    landmarks = landmarks_of(projection.apply(described), sequences.object_index, touches, best)
    return gather_calibration([rows[place] for place in sorted(rows)], landmarks, best)


def gather_calibration(
    rows: Sequence[tuple[int, Floats, Floats]], landmarks: Landmarks, best: BestParameters
) -> Calibration:
    """Gather class, nonconformity (k,) and evidence (k, e) of each training object."""
    labels, nonconformity, evidence = zip(*rows, strict=True)
    return Calibration(
        np.array(bag_sizes(best), dtype=np.int64),
        np.array(labels, dtype=np.int64),
        np.array(nonconformity).T,
        np.array(evidence).transpose(1, 0, 2),
        landmarks,
    )


def landmarks_of(
    projected: Floats, owners: Integers, touches: KnownTouches, best: BestParameters
) -> Landmarks:
    """Give landmarks by sequences (n, p), projected, and their objects (n,), with their touches."""
    seen = projected[:, : best.components]
    return Landmarks(spread_bags(owners, (len(owners),)).means(seen), touches)


def one_classifier(parameters: RecognitionParameters, classifier: str) -> RecognitionParameters:
    """Give parameters by which pipeline `best` fits one classifier alone."""
    best = parameters.best.model_copy(update={"classifiers": (classifier,)})
    return parameters.model_copy(update={"best": best})


def bag_sizes(best: BestParameters) -> tuple[int, ...]:
    """Give the sizes of bags, ascending; 1 where none are wanted."""
    return tuple(sorted(best.bags)) or (1,)


def turn_bags(sequences: int, turn: int, best: BestParameters) -> list[Integers]:
    """Give places of one bag of each size among an object's sequences.

    Which of its bags of a size it is takes turns with the object's number.
    """
    chosen = []
    for size in bag_sizes(best):
        bags = spread_bags(np.zeros(sequences, dtype=np.int64), (size,))
        chosen.append(np.split(bags.places, np.cumsum(bags.counts)[:-1])[turn % len(bags.counts)])
    return chosen


def classify_bags(ballots: Ballots, bags: Sequence[Integers]) -> Floats:
    """Give the answers for bags of an object's n sequences, shape (k, c)."""
    places = np.arange(len(ballots.probabilities))
    return np.array([ballots.together(np.isin(places, bag)[None])[0] for bag in bags])


def bag_evidence(
    marks: Landmarks,
    projected: Floats,
    scores: Floats,
    bags: Sequence[Integers],
    distances: TouchDistances,
    length: int | None = None,
) -> Floats:
    """Give the evidence (k, e) of k bags of an object's sequences.

    The sequences are `projected`, (n, p), and have `scores`, (n, c); `bags` are their places.
    `marks` are of other objects. `distances` are those of the sequences' touches (n, t), of which
    the first `length` count, or all.
    """
    return np.array(
        [
            marks.evidence(projected[bag], scores[bag], distances.nearest(np.s_[bag, :length]))
            for bag in bags
        ]
    )
