"""Study `random_draws`, part of every run: further draws of the places of random strategies.

The run's tables contain draw 0. A single condition contains all further draws, so that one job touches and one job
classifies them.
"""

from __future__ import annotations

from collections.abc import Iterator

from visuohaptic.base.draws import name_of_draw
from visuohaptic.fixations.probing import has_further_draws
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS
from visuohaptic.studies.study import Condition, Study

DRAWN_PIPELINE = "paper"
"""The pipeline whose headline classifier is measured on every draw."""


def drawn_strategies(run: ExperimentParameters) -> tuple[str, ...]:
    """Return the names of the draws after draw 0 of each random strategy, such as ``random#1``."""
    return tuple(
        name_of_draw(strategy, draw)
        for strategy in run.probing.strategies
        if has_further_draws(strategy)
        for draw in range(1, run.probing.random_draws)
    )


def draw_conditions(run: ExperimentParameters) -> Iterator[Condition]:
    """Yield the condition of all further draws, if the run has further draws and pipeline `paper`.

    The condition has the headline classifier, or all classifiers of a run without the headline classifier.
    """
    strategies, headline = drawn_strategies(run), HEADLINE_CLASSIFIERS[DRAWN_PIPELINE]
    classifiers = run.recognition.classifiers
    if strategies and DRAWN_PIPELINE in run.recognition.pipelines:
        yield Condition(
            "further draws",
            {
                "probing.strategies": strategies,
                "recognition.pipelines": (DRAWN_PIPELINE,),
                "recognition.classifiers": (headline,) if headline in classifiers else classifiers,
            },
        )


RANDOM_DRAWS = Study(
    "random_draws",
    "Further draws of random places",
    draw_conditions,
    has_figures=False,
    is_part_of_run=True,
)
