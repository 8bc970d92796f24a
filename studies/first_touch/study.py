"""Study `first_touch`: accuracy after one touch of upright objects by ways to choose its place, and after more touches.

Parts of the gaze model and single channels choose the first touch only. An unknown front is measured with one touch.

The run needs the strategies of ``plug_in/looking.py`` as a plug-in. Study `first_touch_turned` has turned objects.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from visuohaptic.attention.registry import CHANNELS
from visuohaptic.base.draw_names import draw_of, name_of_draw
from visuohaptic.fixations.probing import PLANNED
from visuohaptic.geometry.turning import Turns
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import Frame
from visuohaptic.studies.conditions import ONE_CLASSIFIER, PAPER_AND_OURS
from visuohaptic.studies.study import Changes, Condition, Study, accuracies_step

TOUCHES = (1, 2, 3, 5)
"""Numbers of touches per sequence."""

DRAWS_OF_PLACES = 5
"""Draws of random places on upright objects."""

RANDOM = ("random", "random_visible")
RULES = ("highest", "nearest", "central")
"""Rules of looking without a model."""

PARTS = (
    *("gaze_channels", "gaze_view", "gaze_place", "gaze_shape"),
    *("gaze_facing", "gaze_height", "gaze_front", "gaze_extremity"),
    *("gaze_without_channels", "gaze_without_place", "gaze_without_view", "gaze_without_shape"),
)
"""Parts of the model of people's gaze."""

FRAMES: dict[Turns, tuple[Frame, ...]] = {
    "none": ("full", "vertical"),
    "vertical": ("full", "vertical"),
    "any": ("full", "none"),
}
"""Known parts of the frame by turns. Both pipelines are measured with the full frame, `order_free` with all frames."""


def name_of(looking: str, turns: Turns, draw: int, frame: Frame, touches: int) -> str:
    """Return the name of a condition from the attention, turns and their draw, known frame, and number of touches."""
    return f"{looking} {turns} {draw} {frame} {touches}"


def conditions(_run: ExperimentParameters) -> Iterator[Condition]:
    """Yield the conditions on upright objects: all ways to choose the first touch, and some with more touches."""
    drawn = tuple(
        name_of_draw(strategy, draw) for strategy in RANDOM for draw in range(DRAWS_OF_PLACES)
    )
    looks = ("fixation", "human", *drawn, *RULES)
    first, more = TOUCHES[:1], TOUCHES[1:]
    all_looks = (*looks, "curvature", *PARTS)
    full: tuple[Frame, ...] = ("full",)
    yield from conditions_of_pose("default", "none", 0, all_looks, {}, full, first)
    yield from conditions_of_pose("default", "none", 0, looks, {}, full, more)
    yield from conditions_of_pose("default", "none", 0, looks, {}, ("vertical",), first)
    for channel in CHANNELS:
        weights = {f"attention.weights.{name}": float(name == channel) for name in CHANNELS}
        yield from conditions_of_pose(channel, "none", 0, ("fixation",), weights, full, first)


def conditions_of_pose(
    looking: str,
    turns: Turns,
    draw: int,
    strategies: tuple[str, ...],
    changes: Changes,
    frames: tuple[Frame, ...] | None = None,
    touches: Sequence[int] = TOUCHES,
) -> Iterator[Condition]:
    """Yield one condition per known part of the frame and number of touches.

    Strategies that are not registered are left out: without the plug-in the strategies of the package are left, so that
    a later run of another study can start. `frames` are by default all that are measured with these turns (`FRAMES`).
    """
    registered = tuple(name for name in strategies if draw_of(name)[0] in PLANNED.names)
    for frame in frames or FRAMES[turns]:
        for count in touches:
            pipelines = PAPER_AND_OURS if frame == "full" else ("order_free",)
            yield Condition(
                name_of(looking, turns, draw, frame, count),
                {
                    **ONE_CLASSIFIER,
                    **changes,
                    "recognition.frame": frame,
                    "recognition.touches": count,
                    "recognition.pipelines": pipelines,
                    "probing.strategies": registered,
                },
            )


STUDY = Study(
    "first_touch",
    "The first touch",
    conditions,
    steps=(accuracies_step("first_touch"),),
    has_figures=False,
    kept="results/first_touch.parquet",
)
"""The first touch, by ways to choose its place."""
