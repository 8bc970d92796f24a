"""Leads: by how much one way to choose places is ahead of another, for the two questions of the experiment.

Does seeing help to choose places? Fixation, and random places in sight of the eye, are compared with random places in
reach of the sensor. Does salience help, given that one sees? Fixation is compared with random places in sight.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from visuohaptic.evaluation.by_object import ObjectAccuracies
from visuohaptic.evaluation.intervals import PairedComparison, compare_paired, plain_comparison
from visuohaptic.evaluation.means_over_draws import (
    in_common,
    lead_over_draws,
    mean_over_draws,
    plain_lead,
)
from visuohaptic.recognition.parameters import IntervalParameters

Question = Literal["seeing", "salience"]
"""The two questions of the experiment."""

LeadName = Literal["seeing", "sight", "salience"]

LEADS: Mapping[LeadName, tuple[str, str]] = {
    "seeing": ("fixation", "random"),
    "sight": ("random_visible", "random"),
    "salience": ("fixation", "random_visible"),
}
"""The strategies of each lead: accuracy by the first minus accuracy by the second."""

LEADS_OF: Mapping[Question, tuple[LeadName, ...]] = {
    "seeing": ("seeing", "sight"),
    "salience": ("salience",),
}
"""The leads that answer each question."""


@dataclass(frozen=True)
class DrawnAccuracies:
    """The accuracies of a strategy, one per draw of its places; a strategy without chance has one draw."""

    draws: tuple[ObjectAccuracies, ...]

    @property
    def mean(self) -> ObjectAccuracies:
        """The objects' means over draws."""
        return mean_over_draws(self.draws)


def compare_accuracies(
    first: ObjectAccuracies, second: ObjectAccuracies, parameters: IntervalParameters
) -> PairedComparison | None:
    """Compare the accuracies of objects that both strategies tested, weighted as by the first; None without such objects."""
    first, second = in_common(first, second)
    if not first.objects:
        return None
    return compare_paired(first.accuracy, second.accuracy, first.weights, parameters, first.classes)


def compare_by_lead(
    measured: Mapping[str, DrawnAccuracies], parameters: IntervalParameters
) -> dict[LeadName, dict[str, Any]]:
    """Compute all leads between measured strategies, in types that JSON has.

    Parameters
    ----------
    measured : mapping of str to DrawnAccuracies
        Accuracies of one pipeline and classifier by strategy.
    parameters : IntervalParameters
        The confidence of the intervals and the number of sign changes.

    Returns
    -------
    dict
        By name of `LEADS`, the fields of `PairedComparison`; ``draws`` has the number of draws of the second strategy,
        and the lead over each draw.
    """
    found: dict[LeadName, dict[str, Any]] = {}
    for name, (plus, minus) in LEADS.items():
        if plus not in measured or minus not in measured:
            continue
        first, second = measured[plus].mean, measured[minus]
        compared = compare_accuracies(first, second.mean, parameters)
        if compared is not None:
            found[name] = {
                **plain_comparison(compared),
                "draws": plain_lead(lead_over_draws(first, second.draws)),
            }
    return found
