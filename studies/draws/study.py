"""Study `draws`: the leads of fixation over draws of random places, in reach and in sight."""

from __future__ import annotations

from collections.abc import Iterator

from variants.design import LITERAL, Variant
from visuohaptic.base.draw_names import name_of_draw
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import ONE_CLASSIFIER, PAPER_AND_OURS
from visuohaptic.studies.study import Changes, Condition, Study, accuracies_step

DRAWS = 20
"""Number of draws of the places in both pipelines."""

LITERAL_DRAWS = 5
"""Number of draws of the places in the most literal variant of the paper."""

RANDOM = ("random", "random_visible")
"""Random places in reach of the sensor, and in sight of the eye."""


def conditions(_run: ExperimentParameters) -> Iterator[Condition]:
    """Yield conditions with fixation and draw 0, and with all further draws, of both pipelines and of the literal variant."""
    both = {**ONE_CLASSIFIER, "recognition.pipelines": PAPER_AND_OURS}
    yield from _with_draws("default", both, DRAWS)
    yield from _with_draws("literal", literal_changes(), LITERAL_DRAWS)


def _with_draws(name: str, changes: Changes, draws: int) -> Iterator[Condition]:
    further = tuple(name_of_draw(strategy, draw) for strategy in RANDOM for draw in range(1, draws))
    yield Condition(f"{name}, first draw", {**changes, "probing.strategies": ("fixation", *RANDOM)})
    yield Condition(f"{name}, further draws", {**changes, "probing.strategies": further})


def literal_changes() -> Changes:
    """Return the parameters of the most literal variant of the paper, with the paper's pipeline and its support vector machine."""
    return {
        **Variant("literal", "literal", LITERAL).values,
        **ONE_CLASSIFIER,
        "recognition.pipelines": ("paper",),
    }


STUDY = Study(
    "draws",
    "Twenty draws of random places",
    conditions,
    steps=(accuracies_step("draws"),),
    has_figures=False,
    kept="results/draws.parquet",
)
