"""One answer from any number of sequences: a classifier's own, and that of a classifier of bags.

A bag is some sequences of one object, described by the mean of their descriptors. The embedding of
poses in it is the kernel mean embedding of all the bag's touches. The bag classifier learns from bags
of every size, and is linear: its scores of a bag are the means of its scores of the sequences.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from visuohaptic.base.arrays import BoolArray, FloatArray, IntArray
from visuohaptic.recognition.classifier_parameters import ClassifierParameters
from visuohaptic.recognition.encoding import ROUNDING
from visuohaptic.recognition.gaussian import common_covariance
from visuohaptic.recognition.parameters import BestParameters

TEMPERATURES = np.geomspace(0.02, 50.0, 69)
"""Candidates for what scores are divided by before they become probabilities."""

LEAST_SCORE = -60.0
"""Score of a class that training lacked, and of a probability of 0."""

LEAST_PROBABILITY = 1e-4
"""What a mean probability counts as at least, beside the scores of bags."""

BAG_WEIGHT = 2.0
"""How much more the classifier of bags counts than the other; chosen on 130 objects that set `benchmark` contains."""


@dataclass(frozen=True)
class BagClassifier:
    """A linear discriminant of bags of the classes `trained` (k,).

    The rows of `coefficients` (q, k), and `intercepts` (k,), have mean 0.
    """

    coefficients: FloatArray
    intercepts: FloatArray
    trained: IntArray

    def scores(self, projected: FloatArray, classes: int) -> FloatArray:
        """Give a score a class, 0 for one that training lacked: (n, q) to (n, classes)."""
        found = np.zeros((len(projected), classes))
        found[:, self.trained] = projected @ self.coefficients + self.intercepts
        return found


@dataclass(frozen=True)
class Combination:
    """How the two answers for a bag become one, where training had the `known` (c,) classes.

    `scales` are what the classifier's log probabilities and the bag classifier's scores are divided
    by. The sum is divided by `temperatures` (k,), for bags of so many `views` (k,), ascending.
    """

    scales: tuple[float, float]
    views: FloatArray
    temperatures: FloatArray
    known: BoolArray

    def probabilities(
        self, mean_probabilities: FloatArray, mean_scores: FloatArray, counts: FloatArray
    ) -> FloatArray:
        """Give class probabilities (m, c) of bags of `counts` (m,) sequences by both answers' means."""
        logs = np.log(np.maximum(mean_probabilities, LEAST_PROBABILITY))
        summed = logs / self.scales[0] + mean_scores / self.scales[1]
        places = np.log(counts)
        temperature = np.exp(np.interp(places, np.log(self.views), np.log(self.temperatures)))
        return softmax(np.where(self.known, summed / temperature[:, None], LEAST_SCORE))


@dataclass(frozen=True)
class Ballots:
    """What is known of n sequences: probabilities, and scores of the bag classifier if any, (n, c)."""

    probabilities: FloatArray
    scores: FloatArray | None = None
    combination: Combination | None = None

    def alone(self) -> FloatArray:
        """Give the class probabilities of each sequence by itself, shape (n, c)."""
        return self._answer(self.probabilities, self.scores, np.ones(len(self.probabilities)))

    def together(self, members: BoolArray) -> FloatArray:
        """Give the class probabilities (m, c) of bags; `members` (m, n) are their sequences."""
        counts = members.sum(axis=1, dtype=np.float64)
        # Sums first: those of whole votes are exact, so that a tie is one.
        count_in = members.astype(np.float64)
        probabilities = count_in @ self.probabilities / counts[:, None]
        scores = None if self.scores is None else count_in @ self.scores / counts[:, None]
        return self._answer(probabilities, scores, counts)

    def _answer(
        self, probabilities: FloatArray, scores: FloatArray | None, counts: FloatArray
    ) -> FloatArray:
        if scores is None or self.combination is None:
            return probabilities
        return self.combination.probabilities(probabilities, scores, counts)


@dataclass(frozen=True)
class Bags:
    """Bags: places of the first one's sequences, then the second's, …; `counts` (m,) of each."""

    places: IntArray
    counts: IntArray

    @property
    def first(self) -> IntArray:
        """The place of each bag's first sequence, shape (m,)."""
        return self.places[np.cumsum(self.counts) - self.counts]

    def means(self, rows: FloatArray) -> FloatArray:
        """Take the mean over each bag of rows (n, q), shape (m, q)."""
        from scipy.sparse import csr_array

        shares = np.repeat(1 / self.counts, self.counts)
        starts = np.concatenate([[0], np.cumsum(self.counts)])
        means: FloatArray = (
            csr_array((shares, self.places, starts), (len(self.counts), len(rows))) @ rows
        )
        return means


def spread_choices(total: int, count: int) -> IntArray:
    """Choose `count` of `total` places, evenly spread over a ring, in every way: (k, count).

    Each place is in as many rows as any other; the first ceil(total / count) rows have them all,
    once each where `count` divides `total`.
    """
    steps = np.arange(count) * total // count
    turns = np.arange(total // math.gcd(total, count))
    return np.sort((steps + turns[:, None]) % total, axis=1)


def spread_bags(owners: IntArray, sizes: Sequence[int]) -> Bags:
    """Choose bags of every size among each object's sequences, as `spread_choices` spreads them.

    `owners` (n,) is the object of each sequence, an object's in the order of views. A size beyond
    what an object has becomes all of its sequences. Bags are by object, then by size, none twice.
    """
    places, counts = [], []
    for owner in np.unique(owners):
        own = np.flatnonzero(owners == owner)
        pattern, of_bag = _bag_pattern(len(own), tuple(sizes))
        places.append(own[pattern])
        counts.append(of_bag)
    return Bags(np.concatenate(places), np.concatenate(counts))


@cache
def _bag_pattern(total: int, sizes: tuple[int, ...]) -> tuple[IntArray, IntArray]:
    """Give places and counts of the bags of one object with so many sequences."""
    bags = []
    for size in sorted({min(size, total) for size in sizes}):
        bags += list(spread_choices(total, size)[: math.ceil(total / size)])
    return np.concatenate(bags), np.array([len(bag) for bag in bags])


def fit_bag_classifier(
    projected: FloatArray, labels: IntArray, owners: IntArray, sizes: Sequence[int]
) -> BagClassifier:
    """Fit the linear discriminant of bags of sequences (n, q), of classes and objects (n,)."""
    bags = spread_bags(owners, sizes)
    shrinkage = ClassifierParameters().linear_shrinkage
    trained, counts, means, covariance = common_covariance(
        bags.means(projected), labels[bags.first], shrinkage
    )
    coefficients = np.linalg.solve(covariance, means.T)
    intercepts = np.log(counts / counts.sum()) - np.einsum("kq,qk->k", means, coefficients) / 2
    return BagClassifier(
        coefficients - coefficients.mean(axis=1, keepdims=True),
        intercepts - intercepts.mean(),
        trained,
    )


def fit_combination(
    probabilities: FloatArray,
    scores: FloatArray,
    labels: IntArray,
    owners: IntArray,
    known: BoolArray,
    parameters: BestParameters,
) -> Combination:
    """Fit how both answers for a bag become one, on held-out sequences of classes and objects (n,).

    `probabilities` (n, c) are what the classifier says of them and `scores` (n, c) what the bag
    classifier says, each divided by its deviation over bags, the latter by the weight of bags.
    `known` (c,) says which classes training had.
    """
    bags = spread_bags(owners, parameters.bags)
    logs = np.log(np.maximum(bags.means(probabilities), LEAST_PROBABILITY))
    of_bags = bags.means(scores)
    scales = (_deviation(logs[:, known]), _deviation(of_bags[:, known]) / BAG_WEIGHT)
    summed = (logs / scales[0] + of_bags / scales[1])[:, known]
    places = (np.cumsum(known) - 1)[labels[bags.first]]
    # That all of n objects were right doesn't make the next one certain: the rule of succession.
    doubt = 1 / (len(np.unique(owners)) + 2)
    alike = _alike(bags.counts, owners[bags.first])
    temperatures = [best_temperature(summed[chosen], places[chosen], doubt)[1] for chosen in alike]
    views = np.array([bags.counts[chosen].mean() for chosen in alike])
    return Combination(scales, views, np.array(temperatures), known)


def _alike(counts: IntArray, owners: IntArray) -> list[BoolArray]:
    """Tell which bags share each temperature, by ascending numbers of sequences."""
    # One that rests on few objects would be an accident of these: so from the largest number down,
    # numbers are taken together until half of the objects have bags of them.
    enough = len(np.unique(owners)) / 2
    groups, group = [], counts < 0
    for count in np.unique(counts)[::-1]:
        group = group | (counts == count)
        if len(np.unique(owners[group])) >= enough:
            groups.append(group)
            group = counts < 0
    if group.any():
        groups[-1] = groups[-1] | group
    return groups[::-1]


def _deviation(scores: FloatArray) -> float:
    """Give the deviation of scores (m, k) from the mean of their row; 1 where it is rounding."""
    found = float((scores - scores.mean(axis=1, keepdims=True)).std())
    return found if found > ROUNDING * np.abs(scores).max() else 1.0


def pool_answers(answers: Sequence[FloatArray], weights: Sequence[float]) -> FloatArray:
    """Give the weighted geometric mean of answers, shape (c,) each: a logarithmic opinion pool.

    It is no surer than the surest of them, as views of an object err alike.
    """
    if len(answers) == 1:
        return answers[0]
    shares = np.asarray(weights) / np.sum(weights)
    return softmax(shares @ np.log(np.maximum(answers, np.exp(LEAST_SCORE))))


def softmax(scores: FloatArray) -> FloatArray:
    """Turn scores into probabilities along the last axis."""
    weights = np.exp(scores - scores.max(axis=-1, keepdims=True))
    return weights / weights.sum(axis=-1, keepdims=True)


def best_temperature(
    scores: FloatArray, labels: IntArray, doubt: float = 0.0
) -> tuple[float, float]:
    """Find the temperature of `TEMPERATURES` with the least mean log loss, and that loss in nats.

    `labels` (n,) are the true classes of scores (n, c); `doubt` is the share of the truth that is
    spread over all classes.
    """
    relative = scores - scores.max(axis=1, keepdims=True)
    true = (1 - doubt) * relative[np.arange(len(labels)), labels] + doubt * relative.mean(axis=1)

    count = len(labels)
    weights = np.empty_like(relative)

    @cache
    def loss(place: int) -> float:
        coldness = 1 / TEMPERATURES[place]
        np.exp(np.multiply(relative, coldness, out=weights), out=weights)
        losses = np.log(np.add.reduce(weights, axis=1)) - true * coldness
        return float(np.add.reduce(losses) / count)

    # The loss is convex in 1 / temperature, so it falls before its least value and nowhere after.
    places = range(len(TEMPERATURES) - 1)
    best = bisect_left(places, True, key=lambda place: loss(place + 1) >= loss(place))  # noqa: FBT003
    return loss(best), float(TEMPERATURES[best])
