"""Study `first_touch_turned`: the ways of study `first_touch` to choose the first touch, on turned objects.

The run needs the strategies of ``first_touch/plug_in/looking.py`` as a plug-in. Page and figures are those of study
`first_touch`.
"""

from __future__ import annotations

from collections.abc import Iterator

from first_touch.study import RANDOM, RULES, conditions_of_pose
from visuohaptic.geometry.turning import Turns
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.study import Condition, Step, Study

STRATEGIES = (
    *("fixation", "human", *RANDOM, *RULES),
    *("gaze_channels", "gaze_place", "gaze_without_place"),
)
TURNS: tuple[Turns, ...] = ("vertical", "any")

DRAWS_OF_FEW = 3
"""Draws of the turns of set `paper`. Larger sets have one draw: each object has a turn of its own."""


def conditions(run: ExperimentParameters) -> Iterator[Condition]:
    """Yield the conditions by turns and their draw; each draw of the turns has its own draw of random places."""
    for turns in TURNS:
        for draw in range(DRAWS_OF_FEW if run.meshes.set == "paper" else 1):
            changes = {"meshes.turns": turns, "meshes.turn_draw": draw}
            yield from conditions_of_pose("default", turns, draw, STRATEGIES, changes)


STUDY = Study(
    "first_touch_turned",
    "The first touch on turned objects",
    conditions,
    steps=(
        Step(
            "first_touch_turned",
            "first_touch.accuracies:make_first_touch",
            ("results/first_touch_turned.parquet",),
            needs={"include": {"meshes": {"set"}}},
        ),
    ),
    has_figures=False,
    kept="results/first_touch_turned.parquet",
)
"""The first touch on turned objects, by ways to choose its place."""
