"""The kept leads of more objects, of turned objects and of the most literal variant of the paper, in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from pathlib import Path

import numpy as np

from draws.kept import FOLDER as DRAWS_FOLDER
from draws.kept import KeptSet, read_kept
from turned.kept import FOLDER, HEADLINE_TOUCHES, TurnedCell, TurnedSet, read_turned
from visuohaptic.evaluation.by_object import ObjectAccuracies
from visuohaptic.evaluation.intervals import compare_paired
from visuohaptic.evaluation.leads import LEADS, LEADS_OF, LeadName, Question
from visuohaptic.evaluation.means_over_draws import in_common, lead_over_draws
from visuohaptic.geometry.turning import Turns
from visuohaptic.recognition.parameters import Frame, IntervalParameters
from visuohaptic.report.estimates import Estimate, both_intervals, estimate
from visuohaptic.report.estimates import lead as lead_figure
from visuohaptic.report.leads import KNOWN, Lead, Verdict, verdict
from visuohaptic.report.wording import POSES, counted, listed, percent_points, points

LARGEST_SET = "benchmark"
"""The set of objects with the kept leads of more objects than a run has."""

_PIPELINES = ("paper", "literal", "order_free")


_Condition = tuple[str, Turns, Frame]
"""Pipeline, turns, and known part of the frame."""


@dataclass(frozen=True)
class _Measured:
    """The accuracies of a strategy: means over `count` draws, and each draw if all were kept."""

    mean: ObjectAccuracies
    count: int
    draws: Sequence[ObjectAccuracies] = ()


@dataclass(frozen=True)
class KeptLead(Lead):
    """A kept lead, with the accuracies of the first and the second strategy over the same objects."""

    first: ObjectAccuracies = field(kw_only=True)
    second: ObjectAccuracies = field(kw_only=True)
    intervals: IntervalParameters = field(kw_only=True)

    @cached_property
    def by_class(self) -> Mapping[str, Estimate]:
        """The mean lead of each class's objects, with its interval for new objects."""
        categories = np.array(self.first.classes)
        leads = {}
        for category in np.unique(categories).tolist():
            rows = categories == category
            compared = compare_paired(
                self.first.accuracy[rows],
                self.second.accuracy[rows],
                self.first.weights[rows],
                self.intervals,
            )
            leads[category] = estimate(compared.difference)
        return leads


@dataclass(frozen=True)
class KeptLeads:
    """The kept leads of a set of objects, with the days of their measurement."""

    leads: tuple[KeptLead, ...]
    objects: int
    dates: tuple[str, ...]

    def of(self, question: Question) -> tuple[KeptLead, ...]:
        """Return the leads of a question."""
        return tuple(lead for lead in self.leads if lead.name in LEADS_OF[question])

    def by_class(self) -> list[tuple[KeptLead, ...]]:
        """Return the leads of each pipeline in its first condition, to be shown by class."""
        conditions = dict.fromkeys((lead.pipeline, lead.condition) for lead in self.leads)
        first = dict(reversed(list(conditions)))
        return [
            tuple(lead for lead in self.leads if lead.condition == first[pipeline])
            for pipeline in dict.fromkeys(pipeline for pipeline, _ in conditions)
        ]


def read_kept_leads(
    intervals: IntervalParameters,
    name: str = LARGEST_SET,
    draws_folder: Path = DRAWS_FOLDER,
    turned_folder: Path = FOLDER,
) -> KeptLeads | None:
    """Read the kept leads of a set of objects; None if there are none of the set.

    Leads of upright objects with the whole frame known are means over draws of the places, of the tables in
    `draws_folder`. All other leads are means over draws of the turns, of the tables in `turned_folder`. Raises
    `ReportError` if a kept file is damaged.
    """
    drawn, turned = read_kept(draws_folder).get(name), read_turned(turned_folder).get(name)
    by_condition: dict[_Condition, dict[str, _Measured]] = {}
    if drawn is not None:
        by_condition |= _of_draws(drawn)
    if turned is not None:
        by_condition = {**_of_turns(turned), **by_condition}
    leads = [
        _lead(lead, condition, measured[plus], measured[minus], intervals)
        for condition, measured in by_condition.items()
        for lead, (plus, minus) in LEADS.items()
        if plus in measured and minus in measured
    ]
    if not leads:
        return None
    dates = tuple(sorted({kept.source.date for kept in (drawn, turned) if kept is not None}))
    return KeptLeads(tuple(sorted(leads, key=_place)), max(one.objects for one in leads), dates)


def lead_in_words(lead: Lead) -> str:
    """Return a lead with its intervals, such as ``+2.0 points (new objects −1.0 to +5.0, new classes −4.0 to +8.0)``."""
    return (
        f"{points(lead.difference.mean)} points {both_intervals(lead.difference, points)}".rstrip()
    )


def question_sentence(question: Question, kept: KeptLeads) -> str:
    """Answer a question by kept leads, with the largest lead and the number of conditions in which a lead is shown."""
    found = verdict(kept.of(question))
    said = _salience(found) if question == "salience" else _seeing(found)
    return f"{said} ({counted(kept.objects, 'object')}, after Holm's correction, measured on {listed(kept.dates)})."


def _seeing(found: Verdict) -> str:
    """Return in which poses seeing helps, and the number of comparisons in which places that are seen are ahead."""
    drawn = verdict(found.leads, "classes")
    compared = counted(len(found.leads), "comparison")
    headline = (
        f"Not shown: in none of {compared} are places that are seen ahead of random places in reach"
    )
    if found.ahead:
        poses = [turns for turns in POSES if any(lead.turns == turns for lead in found.ahead)]
        headline = (
            f"It can, if objects are {_poses(poses)}: in {len(found.ahead)} of {compared} places that are seen are ahead of "
            f"random places in reach{_most(found.ahead, max)}"
        )
    return (
        f"{headline}. They are behind in {len(found.behind) or 'none'}{_most(found.behind, min)}. For new classes they are "
        f"ahead in {len(drawn.ahead) or 'none'} and behind in {len(drawn.behind) or 'none'}"
    )


def _poses(turns: Sequence[Turns]) -> str:
    """Return poses of objects in words."""
    if [*turns] == ["none", "vertical"]:
        return "upright"
    return " or ".join(POSES[one] for one in turns)


def _most(leads: Sequence[Lead], end: Callable[..., Lead]) -> str:
    """Return the largest or smallest lead with its condition, after a comma; empty without leads."""
    if not leads:
        return ""
    most = end(leads, key=lambda lead: lead.difference.mean)
    return f",{' most of all' * (len(leads) > 1)} in {most.condition}: {lead_in_words(most)}"


def _salience(found: Verdict) -> str:
    """Return in how many conditions fixations are ahead of random places in sight, and the excluded lead."""
    count = counted(len(found.leads), "condition")
    behind = ""
    if found.behind:
        behind = f". They are behind in {len(found.behind)}{_most(found.behind, min)}"
    if found.ahead:
        return (
            f"In some conditions: in {len(found.ahead)} of {count} fixations are ahead of random places in "
            f"sight{_most(found.ahead, max)}{behind}"
        )
    excluded = ""
    if found.excluded is not None:
        end = verdict(found.leads, "classes").excluded
        more = "" if end is None else f" (for new classes, above {percent_points(end)} points)"
        excluded = f", and a lead above {percent_points(found.excluded)} points is excluded{more}"
    helps = "No, on objects of these classes" if found.word == "no" else "Not shown"
    return f"{helps}: in none of {count} are fixations ahead of random places in sight{excluded}{behind}"


def _of_draws(kept: KeptSet) -> dict[_Condition, dict[str, _Measured]]:
    """Return the accuracies of upright objects, by condition and strategy."""
    return {
        (pipeline, "none", "full"): {
            strategy: _Measured(drawn.mean, len(drawn.draws), drawn.draws)
            for strategy, drawn in measured.accuracies.items()
        }
        for pipeline, measured in kept.pipelines.items()
    }


def _of_turns(kept: TurnedSet) -> dict[_Condition, dict[str, _Measured]]:
    """Return the accuracies of turned objects after `HEADLINE_TOUCHES`, by condition and strategy."""
    found: dict[_Condition, dict[str, _Measured]] = {}
    for frame, cell in product(KNOWN, kept.cells):
        if cell.touches == HEADLINE_TOUCHES and cell.known == frame:
            by_strategy = found.setdefault((cell.pipeline, cell.turns, frame), {})
            by_strategy[cell.strategy] = _Measured(_tested(kept.objects, cell), cell.draws)
    return found


def _tested(objects: tuple[tuple[str, str], ...], cell: TurnedCell) -> ObjectAccuracies:
    """Return the accuracies and weights of the objects that were tested."""
    tested = np.flatnonzero(np.isfinite(cell.accuracy))
    owners = tuple(objects[index] for index in tested)
    return ObjectAccuracies(owners, cell.accuracy[tested], cell.weights[tested])


def _lead(
    name: LeadName,
    condition: _Condition,
    first: _Measured,
    second: _Measured,
    intervals: IntervalParameters,
) -> KeptLead:
    """Compute a lead; the objects that both strategies tested are not empty."""
    plus, minus = in_common(first.mean, second.mean)
    compared = compare_paired(plus.accuracy, minus.accuracy, plus.weights, intervals, plus.classes)
    over_draws = lead_over_draws(first.mean, second.draws) if second.draws else None
    return KeptLead(
        name,
        *condition,
        second.count,
        len(plus.objects),
        lead_figure(compared),
        over_draws.standard_deviation if over_draws else 0.0,
        first=plus,
        second=minus,
        intervals=intervals,
    )


def _place(lead: Lead) -> tuple[int, ...]:
    """Return a sorting key: the paper's pipeline first, upright first, from all to nothing known."""
    return (
        _PIPELINES.index(lead.pipeline),
        list(POSES).index(lead.turns),
        list(KNOWN).index(lead.known),
        list(LEADS).index(lead.name),
    )
