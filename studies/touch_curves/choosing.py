"""Strategy `adaptive`: each next touch has the largest expected information gain.

Before a touch, the position and normal of every candidate are known, as the viewpoint sees
them; the imprint is not. It is predicted from training objects: how often, near such a pose,
objects of each class gave each kind of imprint.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from touch_curves.temperature import fit_temperature
from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.encoding import fit_standardiser
from visuohaptic.recognition.frames import LEAST_SIZE
from visuohaptic.recognition.parameters import OrderFreeParameters
from visuohaptic.studies.learning_policies import (
    Choose,
    LearningPolicy,
    Learnt,
    Lessons,
    Places,
    add_learning_policy,
)

WORDS = 16
"""Number of kinds of imprint."""

COMMON_SHARE = 0.1
"""Share of every class's likelihood that is the mean over the classes, so that none is 0."""

LEAST_LIKELIHOOD = 1e-6
"""Likelihood of a touch unlike any in training."""

SMALLEST_OUTCOME = 1e-300
"""Replaces a probability of 0 in a logarithm; it adds no entropy."""

REHEARSED_TOUCHES = 5
"""Length of the random sequences of training objects that set the temperature."""


@dataclass(frozen=True)
class TouchModel:
    """Likelihood of imprints by pose and class, from t training touches only.

    `poses` (t, 6) are scaled as the kernel needs them; `kinds` (t,) are below `words`. Of other
    objects than those of training, `class_of_owner` (o,) is not looked at.
    """

    poses: FloatArray
    kinds: IntArray
    words: int
    owner: IntArray
    class_of_owner: IntArray
    classes: int
    parameters: OrderFreeParameters

    def log_likelihood(self, poses: FloatArray, left_out: int) -> FloatArray:
        """Give the log likelihood of each word at each pose, by class: (n, 6) to (n, m, c).

        A training object, `left_out`, is ignored, for its own touches must not predict its imprints;
        -1 for none. The only object of a class is kept.
        """
        scaled = scale_poses(poses, self.parameters)
        squares = np.einsum("nd,nd->n", scaled, scaled)[:, None]
        squares = squares + np.einsum("td,td->t", self.poses, self.poses)
        kernel = np.exp(-0.5 * np.maximum(squares - 2 * scaled @ self.poses.T, 0))
        weights = self._weights(left_out)
        found = np.zeros((len(poses), self.words, self.classes))
        for category in range(self.classes):
            rows = np.flatnonzero(self.class_of_owner[self.owner] == category)
            member = np.zeros((len(rows), self.words))
            member[np.arange(len(rows)), self.kinds[rows]] = weights[rows]
            found[:, :, category] = kernel[:, rows] @ member
        common = found.mean(axis=2, keepdims=True)
        mixed = (1 - COMMON_SHARE) * found + COMMON_SHARE * common
        return np.log(mixed + LEAST_LIKELIHOOD)

    def _weights(self, left_out: int) -> FloatArray:
        """Weigh touches so that all objects of a class have the same weight."""
        objects = np.unique(self.owner)
        classes = self.class_of_owner[objects]
        kept = objects[(objects != left_out) | (np.bincount(classes)[classes] == 1)]
        members = np.bincount(self.class_of_owner[kept])[self.class_of_owner[self.owner]]
        weight = 1.0 / members / np.bincount(self.owner)[self.owner]
        return np.where(np.isin(self.owner, kept), weight, 0.0)


def fit_adaptive(
    lessons: Lessons, parameters: ExperimentParameters, generator: np.random.Generator
) -> Learnt:
    """Fit the touch model and its temperature on training objects, whose own touches are chosen without them."""
    model, words = fit_touch_model(lessons, parameters.recognition.order_free, generator)
    known = {
        int(owner): _plan(model, lessons.poses[lessons.owner == owner], int(owner))
        for owner in np.unique(lessons.owner)
    }
    temperature = _fit_temperature(lessons, words(lessons.features), known, generator)

    def begin(places: Places) -> Choose:
        plan = known.get(places.left_out)
        if plan is None or not np.array_equal(plan.poses, places.poses):
            plan = _plan(model, places.poses, places.left_out)
        tempered = replace(plan, log_likelihood=plan.log_likelihood / temperature)
        predicted = tempered.log_likelihood - _log_sum(tempered.log_likelihood)

        def choose(chosen: IntArray, felt: FloatArray) -> IntArray:
            kinds = words(felt.reshape(-1, felt.shape[2])).reshape(chosen.shape)
            return choose_next(
                tempered, predicted, places.view, chosen, kinds, parameters.attention.focus_radius
            )

        return choose

    return begin


ADAPTIVE = LearningPolicy("adaptive", fit_adaptive)
add_learning_policy(ADAPTIVE, "touch_curves")


@dataclass(frozen=True)
class Plan:
    """An object's candidates as the touch model sees them.

    `poses` (n, 6) are those of all candidates; equal ones have one `pose_number` (n,), below u.
    `log_likelihood` is that of each word under each class, (u, m, c).
    """

    poses: FloatArray
    pose_number: IntArray
    log_likelihood: FloatArray


def _plan(model: TouchModel, poses: FloatArray, left_out: int) -> Plan:
    first, seen = np.unique(poses, axis=0, return_inverse=True)
    return Plan(poses, seen.reshape(-1), model.log_likelihood(first, left_out))


def choose_next(
    plan: Plan,
    predicted: FloatArray,
    view: IntArray,
    chosen: IntArray,
    kinds: IntArray,
    focus_radius: float,
) -> IntArray:
    """Choose the next touch of each of an object's viewpoints: candidates, (v,), int64.

    It is the open candidate with the largest expected information gain: the entropy of
    the class is expected to be least after it, averaged over the kinds of imprint with their
    probabilities under the belief so far (D. V. Lindley, Ann. Math. Statist. 27, 1956). The pose is
    known before the touch, so it adds no gain; after the touch, pose and imprint are both evidence.

    `predicted` is the plan's log likelihood with a sum of 1 over the words. `view` is the viewpoint of
    each candidate, (n,), ascending from 0 without a gap. `chosen` are the touches so far, (v, t), and
    `kinds` their words. No two touches are closer than `focus_radius` while there is
    another place; once all places are closed, all but those touched are open again, and at last all.
    """
    views, poses = len(chosen), plan.poses
    belief = np.zeros((views, plan.log_likelihood.shape[2]))
    shut = np.zeros(len(poses), dtype=np.int64)
    for places, words in zip(chosen.T, kinds.T, strict=True):
        belief += plan.log_likelihood[plan.pose_number[places], words]
        steps = poses[:, :3] - poses[places[view], :3]
        near = np.einsum("nd,nd->n", steps, steps) <= focus_radius**2
        shut = np.maximum(shut, near)
        shut[places] += 2
    left = expected_entropy(belief, predicted)[view, plan.pose_number]
    # Lowest first among the least shut: open ones, then near ones, then touched ones.
    order = np.lexsort((left, shut, view))
    return order[np.searchsorted(view, np.arange(views))]


def expected_entropy(belief: FloatArray, log_likelihood: FloatArray) -> FloatArray:
    """Give the uncertainty about the class that is expected to be left after a touch: (v, u), nats.

    `belief` holds the log probabilities of the classes so far, up to a constant, (v, c);
    `log_likelihood` that of each of m outcomes at u places, (u, m, c).
    """
    places, outcomes, classes = log_likelihood.shape
    # Factors that are common to a place or to a sequence cancel; the largest is made 1.
    level = log_likelihood - log_likelihood.max(axis=(1, 2), keepdims=True)
    prior = belief - belief.max(axis=1, keepdims=True)
    weight, likelihood = np.exp(prior), np.exp(level)
    by_class = likelihood.sum(axis=1)
    outcome = weight @ likelihood.reshape(-1, classes).T
    outcome = outcome.reshape(-1, places, outcomes)
    # The entropy of the class given the outcome is that of both less that of the outcome; of
    # both, the logarithm is the sum of the prior's and the likelihood's.
    both = (weight * prior) @ by_class.T + weight @ (likelihood * level).sum(axis=1).T
    alone = (outcome * np.log(np.maximum(outcome, SMALLEST_OUTCOME))).sum(axis=2)
    return np.maximum(alone - both, 0.0) / outcome.sum(axis=2)


def fit_touch_model(
    lessons: Lessons, parameters: OrderFreeParameters, generator: np.random.Generator
) -> tuple[TouchModel, Words]:
    """Fit the touch model on lessons, each place of an object once; also return the words of features.

    The generator starts the words' centres.
    """
    places = np.column_stack([lessons.owner, lessons.poses])
    rows = np.sort(np.unique(places, axis=0, return_index=True)[1])
    words, count = fit_words(lessons.names, lessons.features[rows], generator)
    poses, kinds = scale_poses(lessons.poses[rows], parameters), words(lessons.features[rows])
    of_training = (poses, kinds, count, lessons.owner[rows], lessons.class_of_object)
    return TouchModel(*of_training, lessons.classes, parameters), words


Words = Callable[[FloatArray], IntArray]
"""The kind of imprint (n,) of features (n, k)."""


def fit_words(
    names: Sequence[str], features: FloatArray, generator: np.random.Generator
) -> tuple[Words, int]:
    """Find at most `WORDS` kinds of imprint among features (n, k) by k-means; also return their number.

    All columns but the pose and the contact's states are the skin's. The generator starts the
    centres.
    """
    from sklearn.cluster import KMeans

    columns = [
        place
        for place, name in enumerate(names)
        if name.startswith(("contourlet_", "imprint_")) or name == "sensor_size"
    ]
    logarithmic = [names[place] == "sensor_size" for place in columns]

    def skin_of(rows: FloatArray) -> FloatArray:
        values = rows[:, columns]
        values[:, logarithmic] = np.log(np.maximum(values[:, logarithmic], LEAST_SIZE))
        return values

    standardiser = fit_standardiser(skin_of(features), "standardise")
    scaled = standardiser.apply(skin_of(features))
    count = min(WORDS, len(np.unique(scaled, axis=0)))
    start = int(generator.integers(2**31))
    centres = KMeans(count, n_init=1, random_state=start).fit(scaled).cluster_centers_

    def words(rows: FloatArray) -> IntArray:
        products = np.einsum("nq,mq->nm", standardiser.apply(skin_of(rows)), centres)
        return np.argmin(np.einsum("mq,mq->m", centres, centres) - 2 * products, axis=1)

    return words, count


def scale_poses(poses: FloatArray, parameters: OrderFreeParameters) -> FloatArray:
    """Scale poses for a Gaussian kernel of unit width, left and right being alike: (n, 6) both."""
    scaled = poses / parameters.wave_length
    scaled[:, 3:] *= parameters.normal_weight
    scaled[:, [0, 3]] = np.abs(scaled[:, [0, 3]])
    return scaled


def _log_sum(logarithms: FloatArray) -> FloatArray:
    """Sum over the middle axis what has these logarithms: (u, m, c) to (u, 1, c)."""
    largest = logarithms.max(axis=1, keepdims=True)
    sums: FloatArray = np.exp(logarithms - largest).sum(axis=1, keepdims=True)
    return largest + np.log(sums)


def _fit_temperature(
    lessons: Lessons, kinds: IntArray, plans: Mapping[int, Plan], generator: np.random.Generator
) -> float:
    """Find the temperature that calibrates the belief on training objects left out."""
    scores, labels = [], []
    for owner, plan in plans.items():
        own = lessons.owner == owner
        words, views = kinds[own], len(np.unique(lessons.view[own]))
        drawn = generator.integers(len(words), size=(views, REHEARSED_TOUCHES))
        evidence = plan.log_likelihood[plan.pose_number[drawn], words[drawn]]
        scores.append(evidence.sum(axis=1))
        labels.append(np.full(views, lessons.class_of_object[owner]))
    return fit_temperature(np.concatenate(scores), np.concatenate(labels))
