"""Agents that touch the candidate place with the highest predicted gain, and their training on touched candidates.

The gain of a touch is the rise of the log probability of the true class. Regression trees predict from what the agent
knows by how much the gain at a place exceeds the mean gain at other places. One regression per number of earlier touches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from sklearn.ensemble import HistGradientBoostingRegressor

from touch_agents.candidates import FEATURES, Candidates
from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.recognition.descriptors import describe_sequences, draw_waves
from visuohaptic.recognition.experiment import one_thread
from visuohaptic.recognition.parameters import Frame, RecognitionParameters
from visuohaptic.recognition.pipelines import log_probabilities, make_order_free
from visuohaptic.recognition.splits import held_out_folds
from visuohaptic.tables.phases import IMPRINT_FEATURES

TOUCHES = 5

LEAST_LOG_PROBABILITY = np.log(0.01)
"""Smaller log probabilities count as this value, so that few sure errors do not decide a regression."""

_FELT = [FEATURES.index(name) for name in (*IMPRINT_FEATURES, "sensor_size")]
_POINT, _NORMAL = (
    [FEATURES.index(name) for name in names]
    for names in (("x", "y", "z"), ("normal_x", "normal_y", "normal_z"))
)


@dataclass(frozen=True)
class Learning:
    """Settings of training.

    Attributes
    ----------
    histories : int
        Sequences of touches per start and round.
    compared : int
        Places per sequence and number of touches at which the gain is computed.
    rounds : int
        The first round touches at random, later rounds by the agent of the round before.
    explored : float
        Share of touches at random places in later rounds.
    folds : int
        Folds of training objects; gains of an object come from class probabilities that other objects taught.
    trees, leaves, leaf_rows : int
        Size of a regression: number of trees, leaves of a tree, fewest rows of a leaf.
    rate : float
        Learning rate of the regressions.
    """

    histories: int = 2
    compared: int = 8
    rounds: int = 2
    explored: float = 0.3
    folds: int = 3
    trees: int = 40
    leaves: int = 15
    leaf_rows: int = 300
    rate: float = 0.05


class Eyes:
    """Class probabilities after 1 to `TOUCHES` touches: linear discriminants of the descriptors of `order_free`."""

    def __init__(self, frame: Frame, classes: int, seed: int) -> None:
        self._parameters = RecognitionParameters(frame=frame)
        self._waves = draw_waves(self._parameters.order_free, seed)
        self._classes = classes
        self._fitted: list[Any] = []

    def describe(self, touches: FloatArray) -> FloatArray:
        """Describe sequences of touches: (s, t, f) to (s, d)."""
        return describe_sequences(touches, FEATURES, self._waves, self._parameters)

    def fit(self, touches: FloatArray, labels: IntArray) -> Eyes:
        """Fit on the first 1 to t touches of sequences (s, t, f) of classes (s,)."""
        counts = range(1, touches.shape[1] + 1)
        self._fitted = [
            make_order_free().fit(self.describe(touches[:, :count]), labels) for count in counts
        ]
        return self

    def logs(self, touches: FloatArray) -> FloatArray:
        """Compute log probabilities: (s, t, f) to (s, classes); equal for all classes before the first touch."""
        if not touches.shape[1]:
            return np.full((len(touches), self._classes), -np.log(self._classes))
        fitted = self._fitted[touches.shape[1] - 1]
        return log_probabilities(fitted, self.describe(touches), self._classes)


@dataclass(frozen=True, eq=False)
class Agent:
    """An agent: its class probabilities, and a regression per number of earlier touches; without any it is random."""

    eyes: Eyes
    values: Sequence[Any] = ()

    def touch(
        self,
        candidates: Candidates,
        starts: IntArray,
        generator: np.random.Generator,
        explored: float = 0.0,
    ) -> IntArray:
        """Choose `TOUCHES` places from each start, each place once: indices of candidates (s, touches)."""
        chosen = np.zeros((len(starts), 0), dtype=np.int64)
        for count in range(TOUCHES):
            # Equal scores are ordered at random.
            scores = generator.random(candidates.valid[starts].shape)
            at_random = generator.random(len(starts)) < explored
            if self.values:
                state, places = know(self.eyes, candidates, starts, chosen)
                rows = _join(state, places)
                predicted = self.values[count].predict(rows.reshape(-1, rows.shape[-1]))
                scores = np.where(
                    at_random[:, None], scores, predicted.reshape(scores.shape) + 1e-9 * scores
                )
            scores = np.where(candidates.valid[starts], scores, -np.inf)
            np.put_along_axis(scores, chosen, -np.inf, axis=1)
            chosen = np.column_stack([chosen, scores.argmax(axis=1)])
        return chosen


def know(
    eyes: Eyes, candidates: Candidates, starts: IntArray, chosen: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return what agents know after touches `chosen` (s, t): of the object (s, q), and of each place (s, k, m).

    Of the object: log probabilities, imprint, size, distance from the centre and slope of the last touch. Of a
    place: `Candidates.known`, and distances of its anchor from those of the last, the nearest and all earlier touches.
    """
    felt = touched(candidates, starts, chosen)
    logs = np.maximum(eyes.logs(felt), LEAST_LOG_PROBABILITY)
    if not chosen.shape[1]:
        return logs, candidates.known[starts]
    last = felt[:, -1]
    radius = np.linalg.norm(last[:, _POINT], axis=1)
    slope = (last[:, _POINT] * last[:, _NORMAL]).sum(axis=1) / np.maximum(radius, 1e-9)
    state = np.column_stack([logs, last[:, _FELT], radius, slope])
    anchors = candidates.anchors[starts]
    before = np.take_along_axis(anchors, chosen[:, :, None], axis=1)
    distances = np.linalg.norm(anchors[:, :, None] - before[:, None], axis=-1)
    relations = [distances[..., -1], distances.min(axis=-1), distances.mean(axis=-1)]
    return state, np.concatenate([candidates.known[starts], np.stack(relations, axis=-1)], axis=-1)


def touched(candidates: Candidates, starts: IntArray, chosen: IntArray) -> FloatArray:
    """Return the features of the touches at chosen places (s, t): (s, t, f)."""
    return candidates.touches[starts[:, None], chosen]


def gains(
    eyes: Eyes, candidates: Candidates, starts: IntArray, chosen: IntArray, tried: IntArray
) -> FloatArray:
    """Compute the gain of one more touch at each of places (s, p) after touches `chosen` (s, t): (s, p)."""
    labels = candidates.labels[starts]
    before = _of_truth(eyes.logs(touched(candidates, starts, chosen)), labels)
    count = tried.shape[1]
    sequences = np.column_stack([np.repeat(chosen, count, axis=0), tried.reshape(-1)])
    repeated = np.repeat(starts, count)
    logs = eyes.logs(touched(candidates, repeated, sequences))
    after = _of_truth(logs, np.repeat(labels, count)).reshape(tried.shape)
    return after - before[:, None]


def train(
    candidates: Candidates,
    keys: Sequence[str],
    frame: Frame,
    *,
    learns: bool,
    seed: int,
    learning: Learning | None = None,
) -> Agent:
    """Train an agent on the candidates of the objects `keys`; if not `learns`, it touches at random.

    In both cases the class probabilities are fitted on equally many sequences of the agent itself. Raises `ValueError`
    if a start has too few places.
    """
    own, generator = learning or Learning(), np.random.default_rng(seed)
    first = np.repeat(candidates.starts_of(keys), own.histories)
    fewest, needed = candidates.valid[first].sum(axis=1).min(), TOUCHES - 1 + own.compared
    if fewest < needed:
        raise ValueError(f"A start has {fewest} places; at least {needed} are needed.")
    at_random = Agent(Eyes(frame, len(candidates.classes), seed))
    starts, chosen = first[:0], np.zeros((0, TOUCHES), dtype=np.int64)
    with one_thread():
        lessons: list[_Lesson] = []
        for _ in range(own.rounds):
            new = at_random.touch(candidates, first, generator)
            for lesson in lessons:
                rows = np.flatnonzero(np.isin(candidates.owners[first], lesson.held_out))
                agent = Agent(
                    lesson.eyes, _regressions([x for x in lessons if x is not lesson], own)
                )
                new[rows] = agent.touch(candidates, first[rows], generator, own.explored)
            starts, chosen = np.concatenate([starts, first]), np.concatenate([chosen, new])
            if learns:
                lessons = _lessons(candidates, starts, chosen, frame, seed, own, generator)
        eyes = Eyes(frame, len(candidates.classes), seed)
        eyes.fit(touched(candidates, starts, chosen), candidates.labels[starts])
        return Agent(eyes, _regressions(lessons, own) if learns else ())


@dataclass(frozen=True, eq=False)
class _Lesson:
    """The gains on one fold of objects `held_out`, by class probabilities that the other objects taught."""

    held_out: IntArray
    eyes: Eyes
    known: Sequence[FloatArray]
    gained: Sequence[FloatArray]


def _lessons(
    candidates: Candidates,
    starts: IntArray,
    chosen: IntArray,
    frame: Frame,
    seed: int,
    own: Learning,
    generator: np.random.Generator,
) -> list[_Lesson]:
    """Compute gains after each number of touches, fold by fold of whole objects."""
    labels, owners = candidates.labels[starts], candidates.owners[starts]
    lessons = []
    for train_rows, rows in held_out_folds(labels, owners, own.folds, generator):
        eyes = Eyes(frame, len(candidates.classes), seed)
        eyes.fit(touched(candidates, starts[train_rows], chosen[train_rows]), labels[train_rows])
        known, gained = [], []
        for count in range(TOUCHES):
            before = chosen[rows, :count]
            tried = _draw_places(candidates, starts[rows], before, own.compared, generator)
            found = gains(eyes, candidates, starts[rows], before, tried)
            state, places = know(eyes, candidates, starts[rows], before)
            inputs = _join(state, np.take_along_axis(places, tried[:, :, None], axis=1))
            known.append(inputs.reshape(-1, inputs.shape[-1]))
            gained.append((found - found.mean(axis=1, keepdims=True)).reshape(-1))
        lessons.append(_Lesson(np.unique(owners[rows]), eyes, known, gained))
    return lessons


def _draw_places(
    candidates: Candidates,
    starts: IntArray,
    chosen: IntArray,
    count: int,
    generator: np.random.Generator,
) -> IntArray:
    """Draw `count` different places of each start that are not among `chosen` (s, t): (s, count)."""
    scores = generator.random(candidates.valid[starts].shape)
    scores = np.where(candidates.valid[starts], scores, -np.inf)
    np.put_along_axis(scores, chosen, -np.inf, axis=1)
    return np.argsort(-scores, axis=1)[:, :count]


def _regressions(lessons: Sequence[_Lesson], own: Learning) -> list[Any]:
    """Fit the regression of each number of earlier touches on the gains of some folds."""
    return [
        HistGradientBoostingRegressor(
            max_iter=own.trees,
            max_leaf_nodes=own.leaves,
            min_samples_leaf=own.leaf_rows,
            learning_rate=own.rate,
            early_stopping=False,
            random_state=0,
        ).fit(
            np.concatenate([lesson.known[count] for lesson in lessons]),
            np.concatenate([lesson.gained[count] for lesson in lessons]),
        )
        for count in range(TOUCHES)
    ]


def _join(state: FloatArray, places: FloatArray) -> FloatArray:
    """Join knowledge of the object (s, q) and of p places (s, p, m) in one row per place: (s, p, q + m)."""
    repeated = np.broadcast_to(state[:, None], (*places.shape[:2], state.shape[1]))
    return np.concatenate([repeated, places], axis=-1)


def _of_truth(logs: FloatArray, labels: IntArray) -> FloatArray:
    """Return the log probability of the true class (s,), at least `LEAST_LOG_PROBABILITY`."""
    return np.maximum(logs[np.arange(len(labels)), labels], LEAST_LOG_PROBABILITY)
