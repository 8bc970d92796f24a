"""Measure run time and error rate of every setting of the study."""

from __future__ import annotations

from settings_cost.study import STUDY, settings_of
from visuohaptic.studies.cost.front import write_costs
from visuohaptic.studies.cost.seconds import write_seconds
from visuohaptic.studies.study import StepInputs


def make_seconds(step: StepInputs) -> None:
    """Write `tables.COST_SECONDS` of all settings."""
    write_seconds(step, STUDY, settings_of(step.run), step.run.cost.rounds)


def make_costs(step: StepInputs) -> None:
    """Write `tables.COST` of all settings."""
    write_costs(step, STUDY, settings_of(step.run))
