"""Study `draws`: the lead of fixation over twenty draws of random places, in both pipelines."""

from __future__ import annotations

from collections.abc import Iterator

from visuohaptic.base.draws import name_of_draw
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS, ONE_CLASSIFIER
from visuohaptic.studies.study import Condition, Step, Study

DRAWS = 20


def conditions(_run: ExperimentParameters) -> Iterator[Condition]:
    """Yield two conditions: fixation with draw 0, and all further draws."""
    both = {**ONE_CLASSIFIER, "recognition.pipelines": tuple(HEADLINE_CLASSIFIERS)}
    further = tuple(name_of_draw("random", draw) for draw in range(1, DRAWS))
    yield Condition("first draw", {**both, "probing.strategies": ("fixation", "random")})
    yield Condition("further draws", {**both, "probing.strategies": further})


STUDY = Study(
    "draws",
    "Twenty draws of random places",
    conditions,
    steps=(
        Step(
            "draws",
            "draws.keeping:make_draws",
            ("reports/draws.json",),
            needs={"include": {"meshes": {"set"}}},
        ),
    ),
    has_figures=False,
    is_on_request=True,
)
