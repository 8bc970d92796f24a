"""Study `learned`: the accuracy of pipeline `learned` beside that of `order_free`, on upright objects.

Written before the figures of several views and of turned objects were computed, for objects that chose no setting. Is
`learned` ahead of `order_free`? Each question has Holm's correction for its own settings:

1. By one view of upright objects, for each known part of the frame, strategy and number of touches (24 settings).
2. By all views of an object together, with the most touches (12 settings).
3. On turned objects, by one view and by all, with the most touches (12 settings; study `learned_turned`).

A fourth question was written after a trial on the same 75 objects with 16 touches by fixation in frames `full` and
`none`, where the gains were +3.0 and +4.3 points:

4. By one view of upright objects, with twenty touches (12 settings).
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import get_args

from visuohaptic.geometry.turning import Turns
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import Frame
from visuohaptic.studies.conditions import ONE_CLASSIFIER
from visuohaptic.studies.study import Condition, Study, accuracies_step

PIPELINES = ("order_free", "learned")
STRATEGIES = ("fixation", "random", "random_visible")
FRAMES: tuple[Frame, ...] = get_args(Frame)
TOUCHES = (1, 5)
"""Numbers of touches per sequence, of the first three questions."""
LONG = 20
"""Touches per sequence of the fourth question. A view with fewer places repeats places from the first."""


def conditions(run: ExperimentParameters) -> Iterator[Condition]:
    """Yield the conditions on upright objects."""
    for frame, touches in product(FRAMES, (*TOUCHES, LONG)):
        yield from conditions_of_pose("none", frame, touches, run)


def conditions_of_pose(
    turns: Turns, frame: Frame, touches: int, run: ExperimentParameters
) -> Iterator[Condition]:
    """Yield a condition of one view and, with the most of `TOUCHES`, one of all views of an object together.

    Each object is tested once, because a network takes longer to fit than a discriminant. A single touch whose pose is
    unknown has no coordinates but still an imprint.
    """
    changes = {
        **ONE_CLASSIFIER,
        "meshes.turns": turns,
        "probing.strategies": STRATEGIES,
        "recognition.pipelines": PIPELINES,
        "recognition.frame": frame,
        "recognition.touches": touches,
        "recognition.protocol.protocol": "grouped_folds",
    }
    if touches == LONG:
        changes["probing.when_exhausted"] = "begin_again"
    for votes in (None, run.viewpoints.total) if touches == max(TOUCHES) else (None,):
        yield Condition(f"{turns} {frame} {touches} {votes or 1}", changes, votes=votes)


STUDY = Study(
    "learned",
    "A network of touches",
    conditions,
    steps=(accuracies_step("learned"),),
    has_figures=False,
    kept="results/learned.parquet",
)
"""The network of touches beside the fixed descriptors."""
