"""Looking, touching and both, trained and tested in the same splits: one table of answers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.parameters import CostParameters, ExperimentParameters
from visuohaptic.seeds import spawn_generator
from visuohaptic.studies.ablations import CLASSIFIER
from visuohaptic.studies.conditions import with_changes
from visuohaptic.studies.looking.answers import (
    Answered,
    Descriptors,
    Trial,
    answer_trials,
    ask_if_familiar,
    make_trials,
    multiply,
)
from visuohaptic.studies.looking.seeing import SIGHTS
from visuohaptic.studies.looking.sensing import (
    ADAPTIVE,
    BLIND,
    STRATEGIES,
    Sensed,
    compared,
    most_touches,
    touches_of_run,
)
from visuohaptic.studies.looking.settings import (
    CHECKED,
    CLEAN,
    CUES,
    LOOK,
    PRODUCT,
    SIDE_BY_SIDE,
    STOPPING,
    TOUCH,
)
from visuohaptic.studies.looking.stopping import learn_pace, rule_of_budget
from visuohaptic.tables.schema import build_table
from visuohaptic.tables.studies import CONFIDENCE_BINS, LOOKING

if TYPE_CHECKING:
    from visuohaptic.recognition.sequences import TouchSequences
    from visuohaptic.studies.curves.choosing import Candidates


def measure_looking(sensed: Sensed, run: ExperimentParameters, processes: int) -> pa.Table:
    """Train and test looking, touching and both in every split: `tables.LOOKING`.

    Looking is learnt in clean sight and tested in every sight. Touches are those that a clean look
    leads to, in every sight.
    """
    run = with_changes(run, {"recognition.best.classifiers": (CLASSIFIER,)})
    trials = make_trials(sensed.sequences, run.recognition, run.seed)
    answers = _answer_all(sensed, trials, run, processes)
    record = _Record(sensed.sequences, trials)
    for cue in CUES:
        record.add_sights(cue, answers[cue], "none", 0, run.cost.look_seconds)
    fused = run.cost.look_seconds + run.cost.touch_seconds * touches_of_run(run)
    record.add_sights(
        SIDE_BY_SIDE, answers[SIDE_BY_SIDE], STRATEGIES[0], touches_of_run(run), fused
    )
    for strategy in compared(run.cost):
        series = [answers[strategy, count] for count in range(1, most_touches(run) + 1)]
        _add_strategy(record, strategy, answers[LOOK], series, run.cost)
    return record.table()


def _answer_all(
    sensed: Sensed, trials: Sequence[Trial], run: ExperimentParameters, processes: int
) -> dict[object, list[Answered]]:
    """Train and test every cue, both senses side by side, and every strategy by number of touches."""
    from joblib import Parallel, delayed

    touched = {name: [features] * len(trials) for name, features in sensed.touched.items()}
    if sensed.candidates is not None:
        touched[ADAPTIVE] = _choose(sensed.candidates, trials, run, processes)
    tasks: dict[object, _Task] = {cue: _Task(sensed.seen[cue]) for cue in CUES}
    tasks[SIDE_BY_SIDE] = _Task(sensed.seen[LOOK], touched[STRATEGIES[0]], touches_of_run(run))
    for strategy, features in touched.items():
        for touches in range(1, most_touches(run) + 1):
            tasks[strategy, touches] = _Task(None, features, touches)
    found = Parallel(processes)(
        delayed(_run_task)(task, trials, sensed.sequences, sensed.names, run)
        for task in tasks.values()
    )
    return dict(zip(tasks, found, strict=True))


@dataclass(frozen=True)
class _Task:
    """What is described: views, (s, sights, d), or the first touches of a trial's features, or both."""

    seen: NDArray[np.float32] | None
    touched: Sequence[NDArray[np.float64]] = ()
    touches: int = 0


def _run_task(
    task: _Task,
    trials: Sequence[Trial],
    sequences: TouchSequences,
    names: Sequence[str],
    run: ExperimentParameters,
) -> list[Answered]:
    described = _describe(task, len(trials), names, run)
    return answer_trials(trials, described, sequences, run.recognition, run.seed)


def _describe(
    task: _Task, trials: int, names: Sequence[str], run: ExperimentParameters
) -> Iterator[Sequence[Descriptors]]:
    """Give the descriptors of each trial in each condition of its test."""
    from visuohaptic.recognition.descriptors import describe_sequences, draw_waves

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


def _choose(
    candidates: Candidates, trials: Sequence[Trial], run: ExperimentParameters, processes: int
) -> list[NDArray[np.float64]]:
    """Give the features of the touches with the largest expected information gain, by trial."""
    from joblib import Parallel, delayed

    from visuohaptic.studies.curves.choosing import choose_sequences

    rows = Parallel(processes)(
        delayed(choose_sequences)(
            candidates,
            trial.split,
            most_touches(run),
            run.recognition.best,
            run.attention.focus_radius,
            spawn_generator(run.seed, ADAPTIVE, *trial.split.test.tolist()),
        )
        for trial in trials
    )
    return [candidates.features[chosen] for chosen in rows]


def _add_strategy(
    record: _Record,
    strategy: str,
    look: Sequence[Answered],
    series: Sequence[Sequence[Answered]],
    cost: CostParameters,
) -> None:
    """Record a strategy after each touch: touch alone, with a look, and under the rule that stops."""
    paid = 0.0 if strategy == BLIND else cost.look_seconds
    familiar = [ask_if_familiar(one) for one in look]
    checked = [familiar]
    for touches, answered in enumerate(series, start=1):
        seconds = cost.touch_seconds * touches
        tested = [one.tested[0] for one in answered]
        record.add(CLEAN, TOUCH, tested, strategy, touches, paid + seconds)
        checked.append(record.products(familiar, answered))
        for answer, products in (
            (PRODUCT, record.products(look, answered)),
            (CHECKED, checked[-1]),
        ):
            record.add_sights(answer, products, strategy, touches, cost.look_seconds + seconds)
    for number, by_touches in enumerate(zip(*checked, strict=True)):
        _add_rules(record, strategy, number, by_touches, cost)


def _add_rules(
    record: _Record,
    strategy: str,
    number: int,
    by_touches: Sequence[Answered],
    cost: CostParameters,
) -> None:
    """Record a trial under the rule of each budget, which is learnt on its training objects."""
    rehearsed = np.stack([one.held_out for one in by_touches])
    confidence = rehearsed.max(axis=2)
    labels = record.sequences.labels
    correct = rehearsed.argmax(axis=2) == labels[by_touches[0].places]
    pace = learn_pace(correct, confidence, cost.touch_seconds)
    tested = np.stack([one.tested for one in by_touches])
    for budget in cost.budgets:
        affordable = max(budget - cost.look_seconds, 0) / cost.touch_seconds
        rule = rule_of_budget(pace, confidence, affordable)
        for place, sight in enumerate(SIGHTS):
            answers = tested[:, place]
            made = rule.touches(answers.max(axis=2))
            record.add_one(
                (sight, STOPPING, strategy, len(by_touches) - 1, budget),
                number,
                answers[made, np.arange(len(made))],
                cost.look_seconds + cost.touch_seconds * made.astype(np.float64),
            )


@dataclass
class _Record:
    """Rows of the table as they are measured."""

    sequences: TouchSequences
    trials: Sequence[Trial]
    parts: list[Mapping[str, object]] = field(default_factory=list)

    def products(self, look: Sequence[Answered], touch: Sequence[Answered]) -> list[Answered]:
        """Multiply the answers of looking and touching, trial by trial."""
        labels, owners = self.sequences.labels, self.sequences.object_index
        return [
            multiply(seen, felt, labels, owners) for seen, felt in zip(look, touch, strict=True)
        ]

    def add_sights(
        self, answer: str, answered: Sequence[Answered], strategy: str, touches: int, seconds: float
    ) -> None:
        """Add the answers in every sight."""
        for place, sight in enumerate(SIGHTS):
            tested = [one.tested[place] for one in answered]
            self.add(sight, answer, tested, strategy, touches, seconds)

    def add(
        self,
        sight: str,
        answer: str,
        tested: Sequence[NDArray[np.float64]],
        strategy: str,
        touches: int,
        seconds: float,
    ) -> None:
        """Add the answers (n, c) of every trial, each of which takes as long."""
        for number, one in enumerate(tested):
            key = (sight, answer, strategy, touches, None)
            self.add_one(key, number, one, np.full(len(one), seconds))

    def add_one(
        self,
        key: tuple[str, str, str, int, float | None],
        number: int,
        tested: NDArray[np.float64],
        seconds: NDArray[np.float64],
    ) -> None:
        """Add the answers (n, c) of one trial, which take `seconds`, (n,): a row an object."""
        trial, sequences = self.trials[number], self.sequences
        owners, row = np.unique(sequences.object_index[trial.split.test], return_inverse=True)
        correct = tested.argmax(axis=1) == sequences.labels[trial.split.test]
        confidence = tested.max(axis=1)
        count = np.bincount(row)
        bins = np.minimum((confidence * CONFIDENCE_BINS).astype(int), CONFIDENCE_BINS - 1)
        gaps = np.zeros((len(owners), CONFIDENCE_BINS))
        np.add.at(gaps, (row, bins), correct - confidence)
        objects = np.array(sequences.objects, dtype=object)[owners]
        names = ("sight", "answer", "strategy", "touches", "budget")
        keys = {name: [value] * len(owners) for name, value in zip(names, key, strict=True)}
        self.parts.append(
            {
                **keys,
                "class": objects[:, 0],
                "object": objects[:, 1],
                "split": np.full(len(owners), trial.split.number),
                "repeat": np.full(len(owners), trial.repeat),
                "trials": count,
                "accuracy": np.bincount(row, weights=correct) / count,
                "seconds": np.bincount(row, weights=seconds) / count,
                "gaps": list(gaps),
            }
        )

    def table(self) -> pa.Table:
        columns = {
            name: [value for part in self.parts for value in part[name]]  # type: ignore[attr-defined]
            for name in self.parts[0]
        }
        return build_table(LOOKING, columns)
