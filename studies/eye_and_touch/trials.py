"""Train and test looking, touching and both in the same splits, and write the table of answers."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
from joblib import Parallel, delayed
from numpy.typing import NDArray

from eye_and_touch.answers import (
    Answered,
    answer_splits,
    ask_if_familiar,
    multiply,
)
from eye_and_touch.seeing import SIGHTS
from eye_and_touch.sensing import (
    ADAPTIVE,
    BLIND,
    STRATEGIES,
    Sensed,
    compared,
    most_touches,
    sense_all,
)
from eye_and_touch.study import (
    CHECKED,
    CUES,
    LOOK,
    PRODUCT,
    SIDE_BY_SIDE,
    STOPPING,
    TOUCH,
)
from eye_and_touch.summary import sum_up_senses
from eye_and_touch.tables import CONFIDENCE_BINS, EYE_AND_TOUCH
from touch_curves.choosing import ADAPTIVE as ADAPTIVE_POLICY
from touch_curves.learning import choose_in_split
from visuohaptic.base.errors import ParameterError
from visuohaptic.parameters import CostParameters, ExperimentParameters
from visuohaptic.recognition.descriptors import describe_sequences, draw_waves
from visuohaptic.recognition.splits import Split, draw_splits
from visuohaptic.studies.conditions import touches_of_run
from visuohaptic.studies.figures import write_json
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import build_table, read_table, write_table

if TYPE_CHECKING:
    from visuohaptic.recognition.sequences import TouchSequences


def make_eye_and_touch(step: StepInputs) -> None:
    """Write `EYE_AND_TOUCH`, and its summary as JSON.

    Strategy ``adaptive`` needs an input table of candidates: touches of all locations. Raises `ParameterError` if
    `cost.touch_seconds` is 0.
    """
    run, (table, metrics) = step.run, step.outputs
    if not run.cost.touch_seconds:
        raise ParameterError(
            "cost.touch_seconds is 0, so every touch is worth it; study eye_and_touch needs more than 0."
        )
    tables = step.inputs.get("tables")
    candidates = read_table(FEATURES, tables) if tables else None
    sensed = sense_all(step.inputs["meshes"], candidates, run, step.processes)
    measured = measure_senses(sensed, run, step.processes)
    write_table(EYE_AND_TOUCH, measured, table)
    intervals = run.recognition.intervals
    summary = sum_up_senses(measured, run.cost, touches_of_run(run), intervals)
    write_json(summary, metrics)


def measure_senses(sensed: Sensed, run: ExperimentParameters, processes: int) -> pa.Table:
    """Train and test looking, touching and both in every split; return `EYE_AND_TOUCH`.

    Looking is trained in clean sight and tested in every sight. In every sight the touches are at locations that were
    chosen in clean sight.
    """
    splits = draw_splits(sensed.sequences, run.recognition.protocol, run.seed)
    answers = _answer_all(sensed, splits, run, processes)
    blocks = [
        block
        for key, paid in _paid_answers(answers, sensed.sequences, run)
        for split, (tested, seconds) in zip(splits, paid, strict=True)
        for block in _columns(key, split, tested, seconds, sensed.sequences)
    ]
    columns = {name: list(chain(*(block[name] for block in blocks))) for name in blocks[0]}
    return build_table(EYE_AND_TOUCH, columns)


def _answer_all(
    sensed: Sensed, splits: Sequence[Split], run: ExperimentParameters, processes: int
) -> dict[object, list[Answered]]:
    """Train and test every cue, both senses side by side, and every strategy with every number of touches."""
    touched = {name: [features] * len(splits) for name, features in sensed.touched.items()}
    if sensed.candidates is not None:
        chosen = Parallel(processes)(
            delayed(choose_in_split)(
                ADAPTIVE_POLICY, sensed.candidates, split, most_touches(run), run
            )
            for split in splits
        )
        touched[ADAPTIVE] = [sensed.candidates.features[rows] for rows in chosen]
    tasks: dict[object, dict[str, Any]] = {cue: {"seen": sensed.seen[cue]} for cue in CUES}
    side_by_side = {"touched": touched[STRATEGIES[0]], "touches": touches_of_run(run)}
    tasks[SIDE_BY_SIDE] = {**tasks[LOOK], **side_by_side}
    for strategy, features in touched.items():
        for touches in range(1, most_touches(run) + 1):
            tasks[strategy, touches] = {"touched": features, "touches": touches}
    answers = Parallel(processes)(
        delayed(_answer)(splits, sensed.sequences, run, **task) for task in tasks.values()
    )
    return dict(zip(tasks, answers, strict=True))


def _answer(
    splits: Sequence[Split], sequences: TouchSequences, run: ExperimentParameters, **task: Any
) -> list[Answered]:
    described = _describe(len(splits), sequences.feature_names, run, **task)
    return answer_splits(splits, described, sequences)


def _describe(
    splits: int,
    names: Sequence[str],
    run: ExperimentParameters,
    seen: NDArray[np.float32] | None = None,
    touched: Sequence[NDArray[np.float64]] = (),
    touches: int = 0,
) -> Iterator[Sequence[NDArray[np.floating]]]:
    """Yield, per split, the descriptors of views, of touches, or of both in each condition of the test."""
    views = [] if seen is None else list(np.moveaxis(seen, 1, 0))
    if not touched:
        yield from [views] * splits
        return
    recognition = run.recognition
    waves = draw_waves(recognition.order_free, run.seed)
    described: NDArray[np.float64] | None = None
    for features in touched:
        # Strategies other than `ADAPTIVE` have the same array in every split.
        if features is not described:
            felt = describe_sequences(features[:, :touches], names, waves, recognition)
            described = features
        yield [np.concatenate([felt, view], axis=1) for view in views] or [felt]


Key = Mapping[str, object]
"""Columns of `EYE_AND_TOUCH`: answer, strategy, touches and budget."""

Paid = tuple[NDArray[np.float64], NDArray[np.float64] | float]
"""Probabilities of a split in the first k sights, (k, n, c), and the robot's time, (k, n) or the same for all (s)."""


def _paid_answers(
    answers: Mapping[object, Sequence[Answered]],
    sequences: TouchSequences,
    run: ExperimentParameters,
) -> Iterator[tuple[Key, list[Paid]]]:
    """Yield every answer with the robot's time, as one entry per split."""
    look, touches = run.cost.look_seconds, touches_of_run(run)
    for cue in CUES:
        yield _key(cue, "none", 0), _paid(answers[cue], look)
    seconds = look + run.cost.touch_seconds * touches
    yield _key(SIDE_BY_SIDE, STRATEGIES[0], touches), _paid(answers[SIDE_BY_SIDE], seconds)
    for strategy in compared(run.cost):
        felt = [answers[strategy, count] for count in range(1, most_touches(run) + 1)]
        yield from _of_strategy(strategy, answers[LOOK], felt, sequences, run.cost)


def _key(answer: str, strategy: str, touches: int, budget: float | None = None) -> Key:
    return {"answer": answer, "strategy": strategy, "touches": touches, "budget": budget}


def _paid(answered: Sequence[Answered], seconds: float) -> list[Paid]:
    return [(split.tested, seconds) for split in answered]


def _of_strategy(
    strategy: str,
    looked: Sequence[Answered],
    felt: Sequence[Sequence[Answered]],
    sequences: TouchSequences,
    cost: CostParameters,
) -> Iterator[tuple[Key, list[Paid]]]:
    """Yield the answers of a strategy after each touch: by touch, by touch and look, and by the rule that stops."""
    checked = [[ask_if_familiar(answered) for answered in looked]]
    for touches, touched in enumerate(felt, start=1):
        products, certain = (
            [
                multiply(*pair, sequences.labels, sequences.object_index)
                for pair in zip(seen, touched, strict=True)
            ]
            for seen in (looked, checked[0])
        )
        checked.append(certain)
        touching = cost.touch_seconds * touches
        both = cost.look_seconds + touching
        yield (
            _key(TOUCH, strategy, touches),
            _paid(touched, touching if strategy == BLIND else both),
        )
        yield _key(PRODUCT, strategy, touches), _paid(products, both)
        yield _key(CHECKED, strategy, touches), _paid(certain, both)
    for budget in cost.budgets:
        of_splits = zip(*checked, strict=True)
        stopped = [_stop(by_touches, sequences.labels, budget, cost) for by_touches in of_splits]
        yield _key(STOPPING, strategy, len(felt), budget), stopped


def _stop(
    by_touches: Sequence[Answered],
    labels: NDArray[np.int64],
    budget: float,
    cost: CostParameters,
) -> Paid:
    """Return the answers of a split by the rule that stops; the rule is fitted to its training objects."""
    rehearsed = np.stack([answered.held_out for answered in by_touches])
    confidence = rehearsed.max(axis=2)
    correct = rehearsed.argmax(axis=2) == labels[by_touches[0].indices]
    pace = learn_pace(correct, confidence, cost.touch_seconds)
    affordable = max(budget - cost.look_seconds, 0) / cost.touch_seconds
    worth = worth_of_budget(expected_gain(pace, confidence), affordable)
    tested = np.stack([answered.tested for answered in by_touches])
    counts = touches_made(worth, expected_gain(pace, tested.max(axis=3)))
    answers = np.take_along_axis(tested, counts[None, :, :, None], axis=0)[0]
    return answers, cost.look_seconds + cost.touch_seconds * counts.astype(np.float64)


def learn_pace(
    correct: NDArray[np.bool_], confidence: NDArray[np.float64], touch_seconds: float
) -> NDArray[np.float64]:
    """Compute the share of doubt that one second of touching removes after 0 to k touches.

    Doubt is 1 minus the probability of the likeliest class. The gain of further touches is the rise of accuracy as a
    share of the doubt. The number of further touches with the highest gain per second counts.

    Parameters
    ----------
    correct : ndarray of shape (k + 1, n), bool
        Whether the likeliest class is right after each number of touches, in n rehearsals on training objects.
    confidence : ndarray of shape (k + 1, n)
        Probability of the likeliest class.
    touch_seconds : float
        Time of one touch, s.

    Returns
    -------
    ndarray of shape (k + 1,)
        Share per second; the last is 0.
    """
    right = correct.sum(axis=1)
    doubt = np.maximum((1 - confidence).sum(axis=1), np.finfo(np.float64).tiny)
    pace = np.zeros(len(right))
    for count in range(len(right) - 1):
        further = np.arange(1, len(right) - count)
        shares = np.clip((right[count + 1 :] - right[count]) / doubt[count], 0, 1)
        pace[count] = (shares / (further * touch_seconds)).max()
    return pace


def expected_gain(
    pace: NDArray[np.float64], confidence: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Compute the expected gain of one second of touching: pace (k + 1,) and confidence (k + 1, …) to (k + 1, …)."""
    return np.einsum("k,k...->k...", pace, 1 - confidence)


def touches_made(worth: float, gain: NDArray[np.float64]) -> NDArray[np.int64]:
    """Compute after how many touches the rule stops, from the expected gain after each: (k + 1, …) to (…).

    The rule continues while the expected gain of a second is above `worth`, a probability of a correct answer.
    """
    return np.argmax(gain <= worth, axis=0)


def worth_of_budget(gain: NDArray[np.float64], most_touches: float) -> float:
    """Return the smallest worth of a second for which rehearsals take at most `most_touches` on average.

    `gain` (k + 1, n) is the expected gain of n rehearsals, as from `expected_gain`.
    """
    worths = np.unique([0.0, *gain.ravel()])
    # The larger the worth, the earlier every rehearsal stops.
    enough = bisect_left(
        worths, x=True, key=lambda worth: touches_made(worth, gain).mean() <= most_touches
    )
    return float(worths[enough])


def _columns(
    key: Key,
    split: Split,
    tested: NDArray[np.float64],
    seconds: NDArray[np.float64] | float,
    sequences: TouchSequences,
) -> Iterator[dict[str, Any]]:
    """Yield columns of `EYE_AND_TOUCH` of a split, per sight, with one row per object."""
    owners, row = np.unique(sequences.object_index[split.test], return_inverse=True)
    objects, count = np.array(sequences.objects, dtype=object)[owners], np.bincount(row)
    taken = np.broadcast_to(seconds, tested.shape[:2])
    # Answers by touch have only the first sight, the clean one.
    for sight, answers, spent in zip(SIGHTS, tested, taken, strict=False):
        correct = answers.argmax(axis=1) == sequences.labels[split.test]
        confidence = answers.max(axis=1)
        bins = np.minimum((confidence * CONFIDENCE_BINS).astype(int), CONFIDENCE_BINS - 1)
        gaps = np.zeros((len(owners), CONFIDENCE_BINS))
        np.add.at(gaps, (row, bins), correct - confidence)
        same = {**key, "sight": sight, "split": split.number, "repeat": split.repeat}
        yield {
            **{name: [value] * len(owners) for name, value in same.items()},
            "class": objects[:, 0],
            "object": objects[:, 1],
            "trials": count,
            "accuracy": np.bincount(row, weights=correct) / count,
            "seconds": np.bincount(row, weights=spent) / count,
            "gaps": list(gaps),
        }
