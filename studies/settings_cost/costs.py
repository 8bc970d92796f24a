"""Run time and error rate of every setting of the study."""

from __future__ import annotations

from settings_cost.study import STUDY, settings_of
from visuohaptic.studies.cost.front import write_costs
from visuohaptic.studies.cost.seconds import write_seconds
from visuohaptic.studies.study import Given


def make_seconds(given: Given) -> None:
    """Time every setting side by side: `tables.COST_SECONDS`."""
    write_seconds(given, STUDY, settings_of(given.run), given.run.cost.rounds)


def make_costs(given: Given) -> None:
    """Join error rates and seconds of all settings, and mark the front and the steps: `tables.COST`."""
    write_costs(given, settings_of(given.run))
