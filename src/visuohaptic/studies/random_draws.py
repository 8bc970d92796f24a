"""Study `random_draws`, part of every run: further draws of random places, and random places in sight.

The run's tables contain draw 0 of the run's strategies. A single condition contains all further draws, so that one job
touches and one job classifies them.
"""

from __future__ import annotations

from collections.abc import Iterator

from visuohaptic.active.registry import has_further_draws, strategy_of
from visuohaptic.base.draw_names import name_of_draw
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS
from visuohaptic.studies.study import Changes, Condition, Study

DRAWN_PIPELINE = "paper"
"""The pipeline whose headline classifier is measured on every draw."""

IN_SIGHT = "random_visible"
"""The strategy of random places in sight of the eye."""


def drawn_strategies(run: ExperimentParameters) -> tuple[str, ...]:
    """Return the names of the draws after draw 0 of each random strategy, such as ``random#1``."""
    return tuple(
        name_of_draw(strategy, draw)
        for strategy in run.probing.strategies
        if has_further_draws(strategy)
        for draw in range(1, run.probing.random_draws)
    )


_SECTIONS = {"paper": "recognition", "order_free": "recognition.order_free"}
"""Section of the classifiers of the pipelines that have a choice of classifiers."""


def draw_conditions(run: ExperimentParameters) -> Iterator[Condition]:
    """Yield the conditions with all further draws, and with random places in sight, each where the run needs it.

    Further draws need pipeline `paper`. Random places in sight, one draw, are the opponent of fixation in the question of
    salience; a run with fixation and a random strategy, but without ``random_visible``, gets them in all of its pipelines. The
    classifier is the headline classifier of each pipeline, or all classifiers of a run without the headline classifier.
    """
    strategies, pipelines = drawn_strategies(run), run.recognition.pipelines
    if strategies and DRAWN_PIPELINE in pipelines:
        yield Condition("further draws", _measured(run, strategies, (DRAWN_PIPELINE,)))
    chosen = run.probing.strategies
    is_asked = "fixation" in chosen and any(strategy_of(name).random for name in chosen)
    if is_asked and IN_SIGHT not in chosen:
        yield Condition("in sight", _measured(run, (IN_SIGHT,), pipelines))


def _measured(
    run: ExperimentParameters, strategies: tuple[str, ...], pipelines: tuple[str, ...]
) -> Changes:
    """Return the changes of a condition with one classifier per pipeline where the run has the headline classifier."""
    changes: dict[str, object] = {
        "probing.strategies": strategies,
        "recognition.pipelines": pipelines,
    }
    for pipeline, section in _SECTIONS.items():
        if pipeline in pipelines:
            chosen, headline = (
                run.recognition.classifiers_of(pipeline),
                HEADLINE_CLASSIFIERS[pipeline],
            )
            changes[f"{section}.classifiers"] = (headline,) if headline in chosen else chosen
    return changes


RANDOM_DRAWS = Study(
    "random_draws",
    "Further draws of random places",
    draw_conditions,
    has_figures=False,
    is_part_of_run=True,
)
