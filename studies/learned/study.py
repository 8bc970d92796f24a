"""Study `learned`: the accuracy of pipeline `learned` beside that of `order_free`, in each frame."""

from __future__ import annotations

from collections.abc import Iterator
from typing import get_args

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import Frame
from visuohaptic.studies.conditions import ONE_CLASSIFIER
from visuohaptic.studies.study import Condition, Study, accuracies_step

PIPELINES = ("order_free", "learned")
STRATEGIES = ("fixation", "random", "random_visible")
FRAMES: tuple[Frame, ...] = get_args(Frame)
TOUCHES = (1, 5)
"""Numbers of touches per sequence."""


def conditions(_run: ExperimentParameters) -> Iterator[Condition]:
    """Yield one condition per frame and number of touches.

    Each object is tested once, because a network takes longer to fit than a discriminant. A single touch whose pose is
    unknown has no coordinates but still an imprint.
    """
    for frame in FRAMES:
        for touches in TOUCHES:
            changes = {
                **ONE_CLASSIFIER,
                "probing.strategies": STRATEGIES,
                "recognition.pipelines": PIPELINES,
                "recognition.frame": frame,
                "recognition.touches": touches,
                "recognition.protocol.protocol": "grouped_folds",
            }
            yield Condition(f"{frame} {touches}", changes)


STUDY = Study(
    "learned",
    "A network of touches",
    conditions,
    steps=(accuracies_step("learned"),),
    has_figures=False,
    kept="results/learned.parquet",
)
"""The network of touches beside the fixed descriptors."""
