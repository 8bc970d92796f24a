"""Study `learned_turned`: the pipelines of study `learned` on turned objects. Page and questions are those of `learned`."""

from __future__ import annotations

from collections.abc import Iterator

from learned.study import TOUCHES, conditions_of_pose
from visuohaptic.geometry.turning import Turns
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import Frame
from visuohaptic.studies.study import Condition, Step, Study

POSES: tuple[tuple[Turns, Frame], ...] = (("vertical", "vertical"), ("any", "none"))
"""Turns of the objects, and what they leave known of the frame."""


def conditions(run: ExperimentParameters) -> Iterator[Condition]:
    """Yield the conditions by turns; each object has a turn of its own."""
    for turns, frame in POSES:
        yield from conditions_of_pose(turns, frame, max(TOUCHES), run)


STUDY = Study(
    "learned_turned",
    "A network of touches on turned objects",
    conditions,
    steps=(
        Step(
            "learned_turned",
            "learned.accuracies:make_learned",
            ("results/learned_turned.parquet",),
            needs={"include": {"meshes": {"set"}}},
        ),
    ),
    has_figures=False,
    kept="results/learned_turned.parquet",
)
"""The network of touches beside the fixed descriptors, on turned objects."""
