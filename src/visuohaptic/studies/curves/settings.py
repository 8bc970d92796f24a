"""Accuracy after one touch, two, and so on, by every strategy."""

from __future__ import annotations

from visuohaptic.fixations.probing import STRATEGIES
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.studies.ablations import ALONE
from visuohaptic.studies.conditions import Condition, Study

LONGEST_SEQUENCE = 16
"""Touches of the sequences of which curves over touches are made."""


def curve_study(_run: ExperimentParameters) -> Study:
    """Give the conditions: one touch, two touches, and so on, by all strategies but `adaptive`.

    One that touches places out of reach, whatever the parameters say, is left out.
    """
    strategies = tuple(entry.name for entry in STRATEGIES if entry.unreachable != "keep")
    conditions = tuple(
        Condition(
            touches_name(count),
            {
                **ALONE,
                "probing.strategies": strategies,
                "probing.when_exhausted": "begin_again",
                "recognition.touches": count,
            },
        )
        for count in range(1, LONGEST_SEQUENCE + 1)
    )
    return Study("curves", "Accuracy against touches", conditions)


def touches_name(count: int) -> str:
    """Name the condition of so many touches."""
    return f"{count} touch{'' if count == 1 else 'es'}"
