"""Study `turned`: the accuracy on objects that are turned before the look, by the known part of their frame."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, get_args

from draws.study import literal_changes
from visuohaptic.geometry.turning import Turns
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import Frame
from visuohaptic.studies.conditions import ONE_CLASSIFIER, PAPER_AND_OURS
from visuohaptic.studies.study import (
    DUMP_FOR_CONDITIONS,
    Changes,
    Condition,
    Step,
    Study,
    accuracies_step,
)

Known = Literal["statistics", "none", "centre", "vertical", "full", "trained_upright"]
"""The part of the object's frame that descriptors use: `recognition.frame`, `STATISTICS` or `TRAINED_UPRIGHT`."""

STATISTICS: Literal["statistics"] = "statistics"
"""Nothing of the frame is known; touches and pairs of touches are described only by statistics, without waves."""

TRAINED_UPRIGHT: Literal["trained_upright"] = "trained_upright"
"""The full frame is assumed, and the pipeline was fitted on objects that stand upright and face one way."""

STRATEGIES = ("fixation", "random", "random_visible")
"""Touches by fixation, at random places in reach, and at random places in sight."""

POSES = get_args(Turns)
"""The poses of the objects, as `meshes.turns`."""

DRAWS = 5
"""Number of draws of the turns."""

RECOGNISED_BY: dict[Known, Changes] = {
    STATISTICS: {
        "recognition.frame": "none",
        "recognition.order_free.cues": ("contourlet", "imprint", "sensor", "relations"),
    },
    **{frame: {"recognition.frame": frame} for frame in get_args(Frame)},
}
"""Parameters of the descriptors by known part of the frame."""

FRAMES: dict[Turns, tuple[Known, ...]] = {
    "none": ("none", "centre", "vertical", "full"),
    "vertical": ("none", "centre", "vertical", "full"),
    "any": (STATISTICS, "none", "centre", "full"),
}
"""Known parts of the frame by turns of the objects. The vertical is unknown if objects are turned in any way."""

CURVES: dict[Turns, tuple[Known, ...]] = {
    "none": ("full",),
    "vertical": ("vertical",),
    "any": ("none", "centre", "full"),
}
"""Known parts of the frame, by turns, that are also measured with other numbers of touches than the run's."""

LENGTHS = (1, 2, 10, 20)
"""These numbers of touches."""


LITERAL: Literal["literal"] = "literal"
"""In the name of a condition in place of the known part of the frame: the most literal variant of the paper."""


def name_of(turns: Turns, draw: int, known: Known | Literal["literal"], touches: int) -> str:
    """Return the name of a condition from turns, draw, known part of the frame, and number of touches."""
    return f"{turns} {draw} {known} {touches}"


def conditions(run: ExperimentParameters) -> Iterator[Condition]:
    """Yield one condition per turns, draw, known part of the frame and number of touches, and the literal variant.

    Objects that are not turned have a single draw.
    """
    own = run.recognition.touches or run.attention.fixations
    for turns in POSES:
        for draw in range(1 if turns == "none" else DRAWS):
            pose = {"meshes.turns": turns, "meshes.turn_draw": draw}
            for known in FRAMES[turns]:
                lengths = {own, *LENGTHS} if known in CURVES[turns] else {own}
                for touches in sorted(lengths):
                    is_headline = known == "full" and touches == own
                    changes = {
                        **ONE_CLASSIFIER,
                        **pose,
                        **RECOGNISED_BY[known],
                        "probing.strategies": STRATEGIES,
                        "recognition.touches": touches,
                        "recognition.pipelines": PAPER_AND_OURS if is_headline else ("order_free",),
                    }
                    yield Condition(name_of(turns, draw, known, touches), changes)
            literal = {**pose, **literal_changes(), "probing.strategies": STRATEGIES}
            yield Condition(name_of(turns, draw, LITERAL, own), literal)


STUDY = Study(
    "turned",
    "Turned objects",
    conditions,
    steps=(
        Step(
            "trained_upright",
            "turned.trained_upright:make_trained_upright",
            ("results/trained_upright.parquet",),
            inputs=("recomputed_features",),
            needs=DUMP_FOR_CONDITIONS,
            is_block=True,
            is_shown=False,
        ),
        accuracies_step("turned"),
    ),
    has_figures=False,
    kept="results/turned.parquet",
)
