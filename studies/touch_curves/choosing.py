"""Strategy `adaptive`: each next touch has the largest expected information gain.

Before a touch, the position and normal of every candidate are known, as the viewpoint sees
them; the imprint is not. It is predicted from training objects: how often, near such a pose,
objects of each class gave each kind of imprint.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from touch_curves.temperature import fit_temperature
from visuohaptic.base.errors import RecognitionError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.descriptors import POSE
from visuohaptic.recognition.encoding import fit_standardiser
from visuohaptic.recognition.frames import LEAST_SIZE
from visuohaptic.recognition.parameters import OrderFreeParameters
from visuohaptic.recognition.sequences import TouchSequences, spread_contact_states
from visuohaptic.recognition.splits import Split
from visuohaptic.tables.schema import matrix

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
class Candidates:
    """Where objects may be touched, and the features (n, k) of a touch there.

    `sequences` are the s to choose, one a viewpoint of an object, without features; `sequence` (n,),
    ascending, is the one that each is a candidate for.
    """

    sequences: TouchSequences
    features: NDArray[np.float64]
    sequence: NDArray[np.int64]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the k features."""
        return self.sequences.feature_names

    @property
    def poses(self) -> NDArray[np.float64]:
        """Position and normal of each candidate (n, 6): what is known before a touch."""
        return self.features[:, [self.names.index(name) for name in POSE]]

    @property
    def owner(self) -> NDArray[np.int64]:
        """Each candidate's object (n,)."""
        return self.sequences.object_index[self.sequence]


@dataclass(frozen=True)
class TouchModel:
    """Likelihood of imprints by pose and class, from t training touches only.

    `poses` (t, 6) are scaled as the kernel needs them; `kinds` (t,) are below `words`. Of other
    objects than those of training, `class_of_owner` (o,) is not looked at.
    """

    poses: NDArray[np.float64]
    kinds: NDArray[np.int64]
    words: int
    owner: NDArray[np.int64]
    class_of_owner: NDArray[np.int64]
    classes: int
    parameters: OrderFreeParameters

    def log_likelihood(self, poses: NDArray[np.float64], left_out: int) -> NDArray[np.float64]:
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

    def _weights(self, left_out: int) -> NDArray[np.float64]:
        """Weigh touches so that all objects of a class have the same weight."""
        objects = np.unique(self.owner)
        classes = self.class_of_owner[objects]
        kept = objects[(objects != left_out) | (np.bincount(classes)[classes] == 1)]
        members = np.bincount(self.class_of_owner[kept])[self.class_of_owner[self.owner]]
        weight = 1.0 / members / np.bincount(self.owner)[self.owner]
        return np.where(np.isin(self.owner, kept), weight, 0.0)


def gather_candidates(features: pa.Table, names: Sequence[str]) -> Candidates:
    """Gather the candidates of every viewpoint, sorted by class, object, viewpoint and place.

    `features` are rows of strategy ``adaptive``; the names are columns to take, ``contact_…`` of the
    contact's state. Raises `RecognitionError` if there are none.
    """
    if not len(features):
        raise RecognitionError("There are no candidates to choose touches among.")
    keys = ["class", "object", "viewpoint", "touch"]
    features = spread_contact_states(features)
    features = features.sort_by([(key, "ascending") for key in keys])
    views = list(zip(*(features.column(key).to_pylist() for key in keys[:3]), strict=True))
    distinct = sorted(set(views))
    objects = tuple(sorted({view[:2] for view in distinct}))
    place = {view: number for number, view in enumerate(distinct)}
    sequences = TouchSequences(
        features=np.zeros((len(distinct), 0, len(names))),
        feature_names=tuple(names),
        objects=objects,
        classes=tuple(sorted({name for name, _ in objects})),
        object_index=np.array([objects.index(view[:2]) for view in distinct], dtype=np.int64),
        viewpoint=np.array([view[2] for view in distinct], dtype=np.int64),
    )
    return Candidates(
        sequences,
        matrix(features, names),
        np.array([place[view] for view in views], dtype=np.int64),
    )


def choose_sequences(
    candidates: Candidates,
    split: Split,
    touches: int,
    parameters: OrderFreeParameters,
    focus_radius: float,
    generator: np.random.Generator,
) -> NDArray[np.int64]:
    """Choose every sequence's touches, one after the other: rows of the candidates, (s, touches), int64.

    The model is fitted on the split's training objects; theirs are chosen without the object itself. Of
    a test object only the poses of the candidates and the imprints of touches made are looked at.
    """
    model, words = fit_touch_model(candidates, split, parameters, generator)
    training = np.unique(candidates.sequences.object_index[split.train])
    plans = {}
    for place in range(len(candidates.sequences.objects)):
        rows = np.flatnonzero(candidates.owner == place)
        left_out = place if place in training else -1
        first, seen = np.unique(candidates.poses[rows], axis=0, return_inverse=True)
        plans[place] = (rows, seen.reshape(-1), model.log_likelihood(first, left_out))
    temperature = _fit_temperature(candidates, words, training, plans, generator)
    chosen = np.zeros((len(candidates.sequences.object_index), touches), dtype=np.int64)
    for place, (rows, seen, likelihood) in plans.items():
        members = np.flatnonzero(candidates.sequences.object_index == place)
        own = choose_touches(
            candidates.poses[rows],
            seen,
            np.searchsorted(members, candidates.sequence[rows]),
            likelihood / temperature,
            words[rows],
            touches,
            focus_radius,
        )
        chosen[members] = rows[own]
    return chosen


def choose_features(
    candidates: Candidates, split: Split, touches: int, run: ExperimentParameters
) -> NDArray[np.float64]:
    """Return the features of every sequence's chosen touches, (s, touches, k), by the draws of the split."""
    generator = spawn_generator(run.seed, "adaptive", *split.test.tolist())
    own, focus = run.recognition.order_free, run.attention.focus_radius
    return candidates.features[choose_sequences(candidates, split, touches, own, focus, generator)]


def choose_touches(
    poses: NDArray[np.float64],
    pose_number: NDArray[np.int64],
    view: NDArray[np.int64],
    log_likelihood: NDArray[np.float64],
    kinds: NDArray[np.int64],
    touches: int,
    focus_radius: float,
) -> NDArray[np.int64]:
    """Choose the touches of one object's viewpoints, one after the other: candidates, (v, touches), int64.

    Each next touch is the open candidate with the largest expected information gain: the entropy of
    the class is expected to be least after it, averaged over the kinds of imprint with their
    probabilities under the belief so far (D. V. Lindley, Ann. Math. Statist. 27, 1956). The pose is
    known before the touch, so it adds no gain; after the touch, pose and imprint are both evidence.

    `poses` are those of all candidates, (n, 6); equal ones have one `pose_number`, (n,), below u.
    `view` is the viewpoint of each, (n,), ascending from 0 without a gap. `log_likelihood` is that
    of each word under each class, tempered, (u, m, c). Of `kinds`, the words (n,), only those of
    chosen candidates are looked at. No two touches are closer than `focus_radius` while there is
    another place; once all places are closed, all but those touched are open again, and at last all.
    """
    views = int(view[-1]) + 1
    predicted = log_likelihood - _log_sum(log_likelihood)
    belief = np.zeros((views, log_likelihood.shape[2]))
    shut = np.zeros(len(poses), dtype=np.int64)
    chosen = np.zeros((views, touches), dtype=np.int64)
    starts = np.searchsorted(view, np.arange(views))
    for turn in range(touches):
        left = expected_entropy(belief, predicted)[view, pose_number]
        # Lowest first among the least shut: open ones, then near ones, then touched ones.
        order = np.lexsort((left, shut, view))
        chosen[:, turn] = order[starts]
        belief += log_likelihood[pose_number[chosen[:, turn]], kinds[chosen[:, turn]]]
        steps = poses[:, :3] - poses[chosen[view, turn], :3]
        near = np.einsum("nd,nd->n", steps, steps) <= focus_radius**2
        shut = np.maximum(shut, near)
        shut[chosen[:, turn]] += 2
    return chosen


def expected_entropy(
    belief: NDArray[np.float64], log_likelihood: NDArray[np.float64]
) -> NDArray[np.float64]:
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
    candidates: Candidates,
    split: Split,
    parameters: OrderFreeParameters,
    generator: np.random.Generator,
) -> tuple[TouchModel, NDArray[np.int64]]:
    """Fit the touch model on the candidates of a split's training objects, each place once; also give all words, (n,).

    The generator starts the words' centres.
    """
    sequences, owner = candidates.sequences, candidates.owner
    rows = np.flatnonzero(np.isin(candidates.sequence, split.train))
    places = np.column_stack([owner[rows], candidates.poses[rows]])
    rows = rows[np.sort(np.unique(places, axis=0, return_index=True)[1])]
    kinds, words = imprint_words(candidates, rows, generator)
    classes = np.full(len(sequences.objects), -1)
    training = np.unique(sequences.object_index[split.train])
    classes[training] = sequences.class_of_object[training]
    poses = scale_poses(candidates.poses[rows], parameters)
    of_training = (poses, kinds[rows], words, owner[rows], classes)
    return TouchModel(*of_training, len(sequences.classes), parameters), kinds


def imprint_words(
    candidates: Candidates, rows: NDArray[np.int64], generator: np.random.Generator
) -> tuple[NDArray[np.int64], int]:
    """Find at most `WORDS` kinds of imprint among some rows by k-means: the kind of each candidate, (n,), and their number.

    All columns but the pose and the contact's states are the skin's. The generator starts the
    centres.
    """
    from sklearn.cluster import KMeans

    columns = [
        place
        for place, name in enumerate(candidates.names)
        if name.startswith(("contourlet_", "imprint_")) or name == "sensor_size"
    ]
    values = candidates.features[:, columns]
    logarithmic = [candidates.names[place] == "sensor_size" for place in columns]
    values[:, logarithmic] = np.log(np.maximum(values[:, logarithmic], LEAST_SIZE))
    scaled = fit_standardiser(values[rows], "standardise").apply(values)
    count = min(WORDS, len(np.unique(scaled[rows], axis=0)))
    start = int(generator.integers(2**31))
    centres = KMeans(count, n_init=1, random_state=start).fit(scaled[rows]).cluster_centers_
    products = np.einsum("nq,mq->nm", scaled, centres)
    return np.argmin(np.einsum("mq,mq->m", centres, centres) - 2 * products, axis=1), count


def scale_poses(poses: NDArray[np.float64], parameters: OrderFreeParameters) -> NDArray[np.float64]:
    """Scale poses for a Gaussian kernel of unit width, left and right being alike: (n, 6) both."""
    scaled = poses / parameters.wave_length
    scaled[:, 3:] *= parameters.normal_weight
    scaled[:, [0, 3]] = np.abs(scaled[:, [0, 3]])
    return scaled


def _log_sum(logarithms: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum over the middle axis what has these logarithms: (u, m, c) to (u, 1, c)."""
    largest = logarithms.max(axis=1, keepdims=True)
    sums: NDArray[np.float64] = np.exp(logarithms - largest).sum(axis=1, keepdims=True)
    return largest + np.log(sums)


def _fit_temperature(
    candidates: Candidates,
    words: NDArray[np.int64],
    training: NDArray[np.int64],
    plans: dict[int, tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]],
    generator: np.random.Generator,
) -> float:
    """Find the temperature that calibrates the belief on training objects left out."""
    scores, labels = [], []
    classes = candidates.sequences.class_of_object
    for place in training:
        rows, seen, likelihood = plans[place]
        kinds = words[rows]
        views = len(np.unique(candidates.sequence[rows]))
        drawn = generator.integers(len(rows), size=(views, REHEARSED_TOUCHES))
        scores.append(likelihood[seen[drawn], kinds[drawn]].sum(axis=1))
        labels.append(np.full(views, classes[place]))
    return fit_temperature(np.concatenate(scores), np.concatenate(labels))
