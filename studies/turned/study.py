"""What turning the objects costs: upright and aligned, turned about the vertical, and turned in any way."""

from __future__ import annotations

from collections.abc import Iterator

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.report.turned import POSES
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS, ONE_CLASSIFIER
from visuohaptic.studies.study import Condition, Step, Study

DRAWS = 5
"""Draws of the turns."""


def name_of(turns: str, draw: int) -> str:
    """Name a condition after how its objects are turned, and the draw."""
    return f"{turns} {draw}"


def conditions(_run: ExperimentParameters) -> Iterator[Condition]:
    """Yield each pose of the objects, by draw; objects that are not turned have no draws."""
    same = {
        **ONE_CLASSIFIER,
        "probing.strategies": ("fixation", "random"),
        "recognition.pipelines": tuple(HEADLINE_CLASSIFIERS),
    }
    for turns in POSES:
        for draw in range(1 if turns == "none" else DRAWS):
            changes = {**same, "meshes.turns": turns, "meshes.turn_draw": draw}
            yield Condition(name_of(turns, draw), changes)


STUDY = Study(
    "turned",
    "Turned objects",
    conditions,
    steps=(
        Step(
            "turned",
            "turned.keeping:make_turned",
            ("reports/turned.json",),
            needs={"include": {"meshes": {"set"}}},
        ),
    ),
    has_figures=False,
    is_on_request=True,
)
