"""Known objects in new poses: the accuracy per number of touches, and the touches until an answer is certain."""

from __future__ import annotations

from collections.abc import Iterator

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import ONE_CLASSIFIER
from visuohaptic.studies.study import WITHOUT_EFFECT, Condition, Step, Study

PIPELINE = "order_free"

STRATEGIES = ("fixation", "random")

TURNS = 8
"""Poses of each object, each uniform over all rotations; one is tested, the others train."""

MOST_TOUCHES = 20
"""Touches of a sequence."""


def name_of(turn: int) -> str:
    """Return the name of the condition of a turn, counted from 0."""
    return f"turn {turn}"


def conditions(run: ExperimentParameters) -> Iterator[Condition]:
    """Yield one condition per turn of the objects."""
    for turn in range(TURNS):
        changes = {
            **ONE_CLASSIFIER,
            "meshes.turns": "any",
            "meshes.turn_draw": turn,
            # With one seed, random places would be the same points of the object in every turn.
            "seed": run.seed + turn,
            "probing.strategies": STRATEGIES,
            # So that every view has all touches: one with fewer places is touched there again.
            "probing.when_exhausted": "begin_again",
            "recognition.pipelines": (PIPELINE,),
            "recognition.frame": "none",
            "recognition.touches": MOST_TOUCHES,
        }
        yield Condition(name_of(turn), changes)


STUDY = Study(
    "known_objects",
    "Known objects in new poses",
    conditions,
    steps=(
        Step(
            "known_objects",
            "known_objects.new_touches:make_known_objects",
            ("results/known_objects.parquet", "reports/known_objects.json"),
            inputs=("recomputed_features",),
            needs={"exclude": WITHOUT_EFFECT},
            is_shown=False,
        ),
    ),
    has_figures=False,
    kept="reports/known_objects.json",
)
