"""Study `touch_curves`: accuracy after 1 to 16 touches by every strategy."""

from __future__ import annotations

from collections.abc import Iterator

from visuohaptic.active.registry import STRATEGIES
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.conditions import FIXATION_ONLY
from visuohaptic.studies.study import (
    DUMP_FOR_CONDITIONS,
    WITHOUT_EFFECT,
    Condition,
    Step,
    Study,
)

LONGEST_SEQUENCE = 16
"""The largest number of touches of the curves."""


def curve_conditions(_run: ExperimentParameters) -> Iterator[Condition]:
    """Yield one condition per number of touches, with all strategies of the package.

    Strategies that always keep locations out of reach are left out.
    """
    strategies = tuple(entry.name for entry in STRATEGIES if entry.unreachable != "keep")
    shared = {"probing.strategies": strategies, "probing.when_exhausted": "begin_again"}
    for count in range(1, LONGEST_SEQUENCE + 1):
        yield Condition(
            touches_name(count), {**FIXATION_ONLY, **shared, "recognition.touches": count}
        )


def touches_name(count: int) -> str:
    """Return the name of the condition with `count` touches."""
    return f"{count} touch{'' if count == 1 else 'es'}"


STUDY = Study(
    "touch_curves",
    "Accuracy against touches",
    curve_conditions,
    steps=(
        Step(
            "study_candidates",
            "touch_curves.adaptive:make_candidates",
            ("results/study_candidates.parquet",),
            inputs=("meshes",),
            needs={
                "exclude": {
                    **WITHOUT_EFFECT,
                    "recognition": True,
                    "probing": {"strategies", "random_draws"},
                }
            },
            is_shown=False,
        ),
        Step(
            "study_adaptive",
            "touch_curves.adaptive:make_adaptive_rows",
            ("results/study_adaptive/{pipeline}.parquet",),
            inputs=("results/study_candidates.parquet",),
            needs=DUMP_FOR_CONDITIONS,
            is_block=True,
            is_shown=False,
        ),
        Step(
            "touches_needed",
            "touch_curves.touches_needed:make_touches_needed",
            ("results/touches_needed.parquet", "reports/touch_curves.json"),
        ),
    ),
    kept="reports/touch_curves.json",
)
"""Accuracy against the number of touches by every strategy, including `adaptive`."""
