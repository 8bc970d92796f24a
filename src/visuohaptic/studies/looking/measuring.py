"""Looking, touching and both, trained and tested in the same splits: one table of answers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.errors import ParameterError
from visuohaptic.parameters import CostParameters, ExperimentParameters
from visuohaptic.recognition.descriptors import describe_sequences, draw_waves
from visuohaptic.recognition.experiment import draw_splits
from visuohaptic.seeds import spawn_generator
from visuohaptic.studies.ablations import CLASSIFIER
from visuohaptic.studies.conditions import touches_of_run, with_changes
from visuohaptic.studies.curves.choosing import choose_features
from visuohaptic.studies.figures import write_json
from visuohaptic.studies.looking.answers import (
    Answered,
    Descriptors,
    Trial,
    answer_trials,
    ask_if_familiar,
    multiply,
)
from visuohaptic.studies.looking.figures import sum_up_looking
from visuohaptic.studies.looking.seeing import SIGHTS
from visuohaptic.studies.looking.sensing import (
    ADAPTIVE,
    BLIND,
    STRATEGIES,
    Sensed,
    compared,
    most_touches,
    sense_all,
)
from visuohaptic.studies.looking.settings import (
    CHECKED,
    CUES,
    LOOK,
    PRODUCT,
    SIDE_BY_SIDE,
    STOPPING,
    TOUCH,
)
from visuohaptic.studies.looking.stopping import (
    expected_gain,
    learn_pace,
    touches_made,
    worth_of_budget,
)
from visuohaptic.studies.study import Given
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import build_table, read_table, write_table
from visuohaptic.tables.studies import CONFIDENCE_BINS, LOOKING

if TYPE_CHECKING:
    from visuohaptic.recognition.sequences import TouchSequences


def make_looking(given: Given) -> None:
    """Make `tables.LOOKING`, and its summary as JSON.

    Where strategy ``adaptive`` is compared, it takes a table of all places that it may touch. Raises
    `ParameterError` if a touch is free.
    """
    run, (table, metrics) = given.run, given.outputs
    if not run.cost.touch_seconds:
        raise ParameterError(
            "cost.touch_seconds is 0, so every touch is worth it; study looking needs more than 0."
        )
    tables = given.inputs.get("tables")
    candidates = read_table(FEATURES, tables) if tables else None
    sensed = sense_all(given.inputs["meshes"], candidates, run, given.processes)
    measured = measure_looking(sensed, run, given.processes)
    write_table(LOOKING, measured, table)
    intervals = run.recognition.intervals
    found = sum_up_looking(measured, run.cost, touches_of_run(run), intervals, run.seed)
    write_json(found, metrics)


def measure_looking(sensed: Sensed, run: ExperimentParameters, processes: int) -> pa.Table:
    """Train and test looking, touching and both in every split: `tables.LOOKING`.

    Looking is learnt in clean sight and tested in every sight. Touches are those that a clean look
    leads to, in every sight.
    """
    run = with_changes(run, {"recognition.best.classifiers": (CLASSIFIER,)})
    trials = list(draw_splits(sensed.sequences, run.recognition, run.seed))
    answers = _answer_all(sensed, trials, run, processes)
    found = _measured(answers, sensed.sequences, run)
    parts = [part for one in found for part in _columns(one, trials, sensed.sequences)]
    columns = {name: list(chain(*(part[name] for part in parts))) for name in parts[0]}
    return build_table(LOOKING, columns)


def _answer_all(
    sensed: Sensed, trials: Sequence[Trial], run: ExperimentParameters, processes: int
) -> dict[object, list[Answered]]:
    """Train and test every cue, both senses side by side, and every strategy by number of touches."""
    from joblib import Parallel, delayed

    touched = {name: [features] * len(trials) for name, features in sensed.touched.items()}
    if sensed.candidates is not None:
        touched[ADAPTIVE] = Parallel(processes)(
            delayed(choose_features)(sensed.candidates, split, most_touches(run), run)
            for split, _ in trials
        )
    tasks: dict[object, _Task] = {cue: _Task(sensed.seen[cue]) for cue in CUES}
    tasks[SIDE_BY_SIDE] = _Task(sensed.seen[LOOK], touched[STRATEGIES[0]], touches_of_run(run))
    for strategy, features in touched.items():
        for touches in range(1, most_touches(run) + 1):
            tasks[strategy, touches] = _Task(None, features, touches)
    found = Parallel(processes)(
        delayed(_run_task)(task, trials, sensed.sequences, run) for task in tasks.values()
    )
    return dict(zip(tasks, found, strict=True))


@dataclass(frozen=True)
class _Task:
    """What is described: views, (s, sights, d), or the first touches of a trial's features, or both."""

    seen: NDArray[np.float32] | None
    touched: Sequence[NDArray[np.float64]] = ()
    touches: int = 0


def _run_task(
    task: _Task, trials: Sequence[Trial], sequences: TouchSequences, run: ExperimentParameters
) -> list[Answered]:
    described = _describe(task, len(trials), sequences.feature_names, run)
    return answer_trials(trials, described, sequences, run.recognition, run.seed)


def _describe(
    task: _Task, trials: int, names: Sequence[str], run: ExperimentParameters
) -> Iterator[Sequence[Descriptors]]:
    """Give the descriptors of each trial in each condition of its test."""
    views = [] if task.seen is None else list(np.moveaxis(task.seen, 1, 0))
    if not task.touched:
        yield from [views] * trials
        return
    best = run.recognition.best
    waves = draw_waves(best, spawn_generator(run.seed, "recognition", "waves"))
    of: NDArray[np.float64] | None = None
    for features in task.touched:
        if features is not of:
            touches = describe_sequences(features[:, : task.touches], names, waves, best)
            of = features
        yield [np.concatenate([touches, view], axis=1) for view in views] or [touches]


_Paid = tuple[NDArray[np.float64], NDArray[np.float64] | float]
"""A trial's answers in the first k sights, (k, n, c), and the seconds that each took, (k, n)."""


@dataclass(frozen=True)
class _Measured:
    """One answer, strategy, number of touches and budget: every trial."""

    answer: str
    strategy: str
    touches: int
    trials: Sequence[_Paid]
    budget: float | None = None


def _measured(
    answers: Mapping[object, Sequence[Answered]],
    sequences: TouchSequences,
    run: ExperimentParameters,
) -> Iterator[_Measured]:
    look = run.cost.look_seconds
    for cue in CUES:
        yield _Measured(cue, "none", 0, _paid(answers[cue], look))
    both, touches = answers[SIDE_BY_SIDE], touches_of_run(run)
    seconds = look + run.cost.touch_seconds * touches
    yield _Measured(SIDE_BY_SIDE, STRATEGIES[0], touches, _paid(both, seconds))
    for strategy in compared(run.cost):
        felt = [answers[strategy, count] for count in range(1, most_touches(run) + 1)]
        yield from _of_strategy(strategy, answers[LOOK], felt, sequences, run.cost)


def _paid(answered: Sequence[Answered], seconds: float) -> list[_Paid]:
    return [(one.tested, seconds) for one in answered]


def _of_strategy(
    strategy: str,
    looked: Sequence[Answered],
    felt: Sequence[Sequence[Answered]],
    sequences: TouchSequences,
    cost: CostParameters,
) -> Iterator[_Measured]:
    """Give a strategy after each touch: touch alone, with a look, and under the rule that stops."""

    def with_touch(seen: Sequence[Answered], touched: Sequence[Answered]) -> list[Answered]:
        of_all = (sequences.labels, sequences.object_index)
        return [multiply(*pair, *of_all) for pair in zip(seen, touched, strict=True)]

    look, checked = cost.look_seconds, [[ask_if_familiar(one) for one in looked]]
    for touches, touched in enumerate(felt, start=1):
        seconds = cost.touch_seconds * touches
        alone = (0.0 if strategy == BLIND else look) + seconds
        yield _Measured(TOUCH, strategy, touches, _paid(touched, alone))
        products = with_touch(looked, touched)
        yield _Measured(PRODUCT, strategy, touches, _paid(products, look + seconds))
        checked.append(with_touch(checked[0], touched))
        yield _Measured(CHECKED, strategy, touches, _paid(checked[-1], look + seconds))
    for budget in cost.budgets:
        stopped = [
            _stop(by_touches, sequences.labels, budget, cost)
            for by_touches in zip(*checked, strict=True)
        ]
        yield _Measured(STOPPING, strategy, len(felt), stopped, budget)


def _stop(
    by_touches: Sequence[Answered],
    labels: NDArray[np.int64],
    budget: float,
    cost: CostParameters,
) -> _Paid:
    """Answer a trial under the rule of a budget, which is learnt on its training objects."""
    rehearsed = np.stack([one.held_out for one in by_touches])
    confidence = rehearsed.max(axis=2)
    correct = rehearsed.argmax(axis=2) == labels[by_touches[0].places]
    pace = learn_pace(correct, confidence, cost.touch_seconds)
    affordable = max(budget - cost.look_seconds, 0) / cost.touch_seconds
    worth = worth_of_budget(expected_gain(pace, confidence), affordable)
    tested = np.stack([one.tested for one in by_touches])
    made = touches_made(worth, expected_gain(pace, tested.max(axis=3)))
    answers = np.take_along_axis(tested, made[None, :, :, None], axis=0)[0]
    return answers, cost.look_seconds + cost.touch_seconds * made.astype(np.float64)


def _columns(
    one: _Measured, trials: Sequence[Trial], sequences: TouchSequences
) -> Iterator[Mapping[str, Sequence[object] | NDArray[np.generic]]]:
    """Give columns of `tables.LOOKING` of each trial and sight: a row an object."""
    for (split, repeat), (tested, seconds) in zip(trials, one.trials, strict=True):
        owners, row = np.unique(sequences.object_index[split.test], return_inverse=True)
        objects, count = np.array(sequences.objects, dtype=object)[owners], np.bincount(row)
        taken = np.broadcast_to(seconds, tested.shape[:2])
        # Touch alone is tested in clean sight, which is the first.
        for sight, answers, spent in zip(SIGHTS, tested, taken, strict=False):
            correct = answers.argmax(axis=1) == sequences.labels[split.test]
            confidence = answers.max(axis=1)
            bins = np.minimum((confidence * CONFIDENCE_BINS).astype(int), CONFIDENCE_BINS - 1)
            gaps = np.zeros((len(owners), CONFIDENCE_BINS))
            np.add.at(gaps, (row, bins), correct - confidence)
            same = {
                "sight": sight, "answer": one.answer, "strategy": one.strategy,
                "touches": one.touches, "budget": one.budget,
                "split": split.number, "repeat": repeat,
            }  # fmt: skip
            yield {
                **{name: [value] * len(owners) for name, value in same.items()},
                "class": objects[:, 0],
                "object": objects[:, 1],
                "trials": count,
                "accuracy": np.bincount(row, weights=correct) / count,
                "seconds": np.bincount(row, weights=spent) / count,
                "gaps": list(gaps),
            }
