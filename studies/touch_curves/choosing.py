"""Strategy `adaptive`: each next touch has the largest expected information gain.

Before a touch, the position and normal of every candidate are known, as the viewpoint sees them. The imprint is
unknown. Its probability is estimated from training objects: the frequency of each kind of imprint near the same pose,
per class.
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
"""Share of the mean over the classes in the likelihood of each class, so that no likelihood is 0."""

LEAST_LIKELIHOOD = 1e-6
"""Likelihood of a touch unlike any in training."""

SMALLEST_OUTCOME = 1e-300
"""Replaces a probability of 0 in a logarithm; the product of both adds no entropy."""

REHEARSED_TOUCHES = 5
"""Length of the random sequences of training objects that set the temperature."""


@dataclass(frozen=True)
class TouchModel:
    """Likelihood of kinds of imprint by pose and class, estimated from t training touches.

    Attributes
    ----------
    poses : ndarray of shape (t, 6)
        Poses from `scale_poses`.
    kinds : ndarray of shape (t,), int64
        Kind of imprint, 0 to `words` - 1.
    words : int
        Number of kinds of imprint, m.
    owner : ndarray of shape (t,), int64
        Index of the object of each touch.
    class_of_owner : ndarray of shape (o,), int64
        Class of each object; only entries of training objects are used.
    classes : int
        Number of classes, c.
    parameters : OrderFreeParameters
        Scale of positions and normals.
    """

    poses: FloatArray
    kinds: IntArray
    words: int
    owner: IntArray
    class_of_owner: IntArray
    classes: int
    parameters: OrderFreeParameters

    def log_likelihood(self, poses: FloatArray, left_out: int) -> FloatArray:
        """Compute the log likelihood of each kind of imprint at each pose by class: (n, 6) to (n, m, c).

        Touches of training object `left_out` are ignored, unless the object is the only one of its class; -1 ignores
        none. An object's own touches must not predict its imprints.
        """
        scaled = scale_poses(poses, self.parameters)
        squares = np.einsum("nd,nd->n", scaled, scaled)[:, None]
        squares = squares + np.einsum("td,td->t", self.poses, self.poses)
        kernel = np.exp(-0.5 * np.maximum(squares - 2 * scaled @ self.poses.T, 0))
        weights = self._weights(left_out)
        likelihood = np.zeros((len(poses), self.words, self.classes))
        for category in range(self.classes):
            rows = np.flatnonzero(self.class_of_owner[self.owner] == category)
            member = np.zeros((len(rows), self.words))
            member[np.arange(len(rows)), self.kinds[rows]] = weights[rows]
            likelihood[:, :, category] = kernel[:, rows] @ member
        common = likelihood.mean(axis=2, keepdims=True)
        mixed = (1 - COMMON_SHARE) * likelihood + COMMON_SHARE * common
        return np.log(mixed + LEAST_LIKELIHOOD)

    def _weights(self, left_out: int) -> FloatArray:
        """Return weights of touches with which all objects of a class have the same total weight."""
        objects = np.unique(self.owner)
        classes = self.class_of_owner[objects]
        kept = objects[(objects != left_out) | (np.bincount(classes)[classes] == 1)]
        members = np.bincount(self.class_of_owner[kept])[self.class_of_owner[self.owner]]
        weight = 1.0 / members / np.bincount(self.owner)[self.owner]
        return np.where(np.isin(self.owner, kept), weight, 0.0)


def fit_adaptive(
    lessons: Lessons, parameters: ExperimentParameters, generator: np.random.Generator
) -> Learnt:
    """Fit the touch model and its temperature on training objects.

    The touches of a training object are chosen without its own training touches.
    """
    model, words = fit_touch_model(lessons, parameters.recognition.order_free, generator)
    known = {
        int(owner): _find_likelihoods(model, lessons.poses[lessons.owner == owner], int(owner))
        for owner in np.unique(lessons.owner)
    }
    temperature = _fit_temperature(lessons, words(lessons.features), known, generator)

    def begin(places: Places) -> Choose:
        likelihoods = known.get(places.left_out)
        if likelihoods is None or not np.array_equal(likelihoods.poses, places.poses):
            likelihoods = _find_likelihoods(model, places.poses, places.left_out)
        tempered = replace(likelihoods, log_likelihood=likelihoods.log_likelihood / temperature)
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
class CandidateLikelihoods:
    """Log likelihoods of an object's candidates.

    Attributes
    ----------
    poses : ndarray of shape (n, 6)
        Pose of each candidate.
    pose_number : ndarray of shape (n,), int64
        Index of each pose among the u distinct poses.
    log_likelihood : ndarray of shape (u, m, c)
        Log likelihood of each kind of imprint under each class, at each distinct pose.
    """

    poses: FloatArray
    pose_number: IntArray
    log_likelihood: FloatArray


def _find_likelihoods(model: TouchModel, poses: FloatArray, left_out: int) -> CandidateLikelihoods:
    distinct, number = np.unique(poses, axis=0, return_inverse=True)
    return CandidateLikelihoods(poses, number.reshape(-1), model.log_likelihood(distinct, left_out))


def choose_next(
    likelihoods: CandidateLikelihoods,
    predicted: FloatArray,
    view: IntArray,
    chosen: IntArray,
    kinds: IntArray,
    focus_radius: float,
) -> IntArray:
    """Choose the next touch of each of an object's v viewpoints.

    The next touch is the open candidate with the largest expected information gain: the entropy of the class after the
    touch is smallest, averaged over the kinds of imprint with their probabilities under the current belief (D. V.
    Lindley, Ann. Math. Statist. 27, 1956). The pose is known before the touch and adds no gain. After the touch, both
    pose and imprint are evidence. Candidates within `focus_radius` of a touch are closed. If all are closed, untouched
    candidates count as open; if all are touched, all candidates do.

    Parameters
    ----------
    likelihoods : CandidateLikelihoods
        Log likelihoods of the n candidates.
    predicted : ndarray of shape (u, m, c)
        The log likelihoods, normalised to a sum of 1 over the kinds of imprint.
    view : ndarray of shape (n,), int64
        Viewpoint of each candidate, 0 to v - 1, ascending.
    chosen, kinds : ndarray of shape (v, t), int64
        Candidates touched so far, and the kinds of their imprints.
    focus_radius : float
        Least distance of touches, object radii.

    Returns
    -------
    ndarray of shape (v,), int64
        The chosen candidates.
    """
    views, poses = len(chosen), likelihoods.poses
    belief = np.zeros((views, likelihoods.log_likelihood.shape[2]))
    closed = np.zeros(
        len(poses), dtype=np.int64
    )  # 0 for open, 1 for near a touch, 2 and more for touched
    for touched, words in zip(chosen.T, kinds.T, strict=True):
        belief += likelihoods.log_likelihood[likelihoods.pose_number[touched], words]
        steps = poses[:, :3] - poses[touched[view], :3]
        near = np.einsum("nd,nd->n", steps, steps) <= focus_radius**2
        closed = np.maximum(closed, near)
        closed[touched] += 2
    entropy = expected_entropy(belief, predicted)[view, likelihoods.pose_number]
    order = np.lexsort((entropy, closed, view))
    return order[np.searchsorted(view, np.arange(views))]


def expected_entropy(belief: FloatArray, log_likelihood: FloatArray) -> FloatArray:
    """Compute the expected entropy of the class after a touch.

    Parameters
    ----------
    belief : ndarray of shape (v, c)
        Log probabilities of the classes so far, each row up to a constant.
    log_likelihood : ndarray of shape (u, m, c)
        Log likelihood of m outcomes under c classes at u poses.

    Returns
    -------
    ndarray of shape (v, u)
        Entropy, nats.
    """
    poses, outcomes, classes = log_likelihood.shape
    # Common factors of a pose or a sequence cancel, so scale the largest to 1.
    level = log_likelihood - log_likelihood.max(axis=(1, 2), keepdims=True)
    prior = belief - belief.max(axis=1, keepdims=True)
    weight, likelihood = np.exp(prior), np.exp(level)
    by_class = likelihood.sum(axis=1)
    outcome = weight @ likelihood.reshape(-1, classes).T
    outcome = outcome.reshape(-1, poses, outcomes)
    # H(class | outcome) = H(class, outcome) - H(outcome), both up to the sign and the sum of the weights.
    # log p(class, outcome) = prior + level.
    joint = (weight * prior) @ by_class.T + weight @ (likelihood * level).sum(axis=1).T
    marginal = (outcome * np.log(np.maximum(outcome, SMALLEST_OUTCOME))).sum(axis=2)
    return np.maximum(marginal - joint, 0.0) / outcome.sum(axis=2)


def fit_touch_model(
    lessons: Lessons, parameters: OrderFreeParameters, generator: np.random.Generator
) -> tuple[TouchModel, Words]:
    """Fit the touch model on lessons; equal poses of an object count once.

    The generator draws the initial centres of k-means. Also returns the function from features to kinds of imprint.
    """
    owners_and_poses = np.column_stack([lessons.owner, lessons.poses])
    rows = np.sort(np.unique(owners_and_poses, axis=0, return_index=True)[1])
    words, count = fit_words(lessons.names, lessons.features[rows], generator)
    poses, kinds = scale_poses(lessons.poses[rows], parameters), words(lessons.features[rows])
    of_training = (poses, kinds, count, lessons.owner[rows], lessons.class_of_object)
    return TouchModel(*of_training, lessons.classes, parameters), words


Words = Callable[[FloatArray], IntArray]
"""Returns the kind of imprint (n,) of features (n, k)."""


def fit_words(
    names: Sequence[str], features: FloatArray, generator: np.random.Generator
) -> tuple[Words, int]:
    """Cluster the imprints of features (n, k) to at most `WORDS` kinds by k-means.

    Columns of contourlets, imprint and sensor size are used. The generator draws the initial centres. Returns the
    function from features to kinds, and the number of kinds.
    """
    from sklearn.cluster import KMeans

    columns = [
        column
        for column, name in enumerate(names)
        if name.startswith(("contourlet_", "imprint_")) or name == "sensor_size"
    ]
    logarithmic = [names[column] == "sensor_size" for column in columns]

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
    """Scale poses (n, 6) for a Gaussian kernel of unit width; x is an absolute value, so left equals right."""
    scaled = poses / parameters.wave_length
    scaled[:, 3:] *= parameters.normal_weight
    scaled[:, [0, 3]] = np.abs(scaled[:, [0, 3]])
    return scaled


def _log_sum(logarithms: FloatArray) -> FloatArray:
    """Compute the log of the sum of exponentials over the middle axis: (u, m, c) to (u, 1, c)."""
    largest = logarithms.max(axis=1, keepdims=True)
    sums: FloatArray = np.exp(logarithms - largest).sum(axis=1, keepdims=True)
    return largest + np.log(sums)


def _fit_temperature(
    lessons: Lessons,
    kinds: IntArray,
    likelihoods_of: Mapping[int, CandidateLikelihoods],
    generator: np.random.Generator,
) -> float:
    """Fit the temperature that calibrates the belief on random touches of training objects that are left out."""
    scores, labels = [], []
    for owner, likelihoods in likelihoods_of.items():
        own = lessons.owner == owner
        words, views = kinds[own], len(np.unique(lessons.view[own]))
        drawn = generator.integers(len(words), size=(views, REHEARSED_TOUCHES))
        evidence = likelihoods.log_likelihood[likelihoods.pose_number[drawn], words[drawn]]
        scores.append(evidence.sum(axis=1))
        labels.append(np.full(views, lessons.class_of_object[owner]))
    return fit_temperature(np.concatenate(scores), np.concatenate(labels))
