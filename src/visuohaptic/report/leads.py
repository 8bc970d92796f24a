"""The leads of one way to choose places over another, in words: answers to the two questions of the experiment.

A run has leads of its own objects in ``reports/metrics.json``. Leads of more objects, of turned objects and of the most
literal variant of the paper are kept with the package (`draws` and `turned`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from visuohaptic.evaluation.draws import ObjectAccuracies, in_common, lead_over_draws
from visuohaptic.evaluation.intervals import compare_paired, holm
from visuohaptic.evaluation.leads import LEADS, LEADS_OF, LeadName, Question
from visuohaptic.geometry.turning import Turns
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.draws import KeptSet, kept_accuracies, read_kept, tested_accuracies
from visuohaptic.report.estimates import Figure, both_intervals, estimate
from visuohaptic.report.estimates import lead as lead_figure
from visuohaptic.report.estimates import measured as measured_figure
from visuohaptic.report.turned import (
    HEADLINE_TOUCHES,
    KNOWN,
    POSES,
    STATISTICS,
    TRAINED_UPRIGHT,
    Known,
    TurnedSet,
    read_turned,
)
from visuohaptic.report.wording import counted, listed, percent_points, pipeline_name, points

SIGNIFICANCE = 0.05
"""A lead is shown if its p value, corrected by Holm for the number of leads of the question, is below this level."""

MARGIN = 0.05
"""The largest lead, as a share, that an answer ``no`` may leave open: a lead of five points."""

LARGEST_SET = "benchmark"
"""The set of objects with the kept leads of more objects than a run has."""

Word = Literal["yes", "no", "not settled"]

Over = Literal["objects", "classes"]
"""Whether an interval is for new objects of the same classes, or for new classes."""

PLACES: Mapping[str, str] = {
    "fixation": "fixations",
    "random": "random places in reach",
    "random_visible": "random places in sight",
}
"""The places of the compared strategies, in words."""

_PIPELINES = ("paper", "literal", "order_free")
_LEFT_OUT = (STATISTICS, TRAINED_UPRIGHT)


_Condition = tuple[str, Turns, Known]
"""Pipeline, turns, and known part of the frame."""


@dataclass(frozen=True)
class _Measured:
    """The accuracies of a strategy: means over `count` draws, and each draw if all were kept."""

    mean: ObjectAccuracies
    count: int
    draws: Sequence[ObjectAccuracies] = ()


@dataclass(frozen=True)
class Lead:
    """A lead, the mean over draws, with its intervals over new objects and over new classes.

    Attributes
    ----------
    name : str
        The compared strategies, by name of `LEADS`.
    pipeline : str
        The pipeline; ``literal`` is the paper's pipeline in the most literal variant of the paper.
    turns, known : str
        The pose of the objects, and the part of their frame that the pipeline knows.
    draws : int
        The number of draws of random places, or of the turns with one draw of places each.
    objects : int
        The number of objects that both strategies tested.
    difference : Figure
        The lead as a share, with intervals and p values for new objects of the same classes and for new classes.
    deviation : float
        The standard deviation over draws, as a share; 0 for a single draw.
    by_class : mapping of str to Figure
        The mean lead of each class's objects; empty for leads of a run.
    """

    name: LeadName
    pipeline: str
    turns: Turns
    known: Known
    draws: int
    objects: int
    difference: Figure
    deviation: float = 0.0
    by_class: Mapping[str, Figure] = field(default_factory=dict)

    @property
    def p_value(self) -> float:
        """The two-sided p value over objects; 1 where there is none."""
        return 1.0 if self.difference.p_value is None else self.difference.p_value

    @property
    def p_value_new_classes(self) -> float:
        """The two-sided p value if classes are a sample, too; 1 where there is none, as with a single class."""
        p_value = self.difference.p_value_new_classes
        return 1.0 if p_value is None else p_value

    @property
    def places(self) -> tuple[str, str]:
        """The compared places in words: the lead is of the first over the second."""
        first, second = LEADS[self.name]
        return PLACES[first], PLACES[second]

    @property
    def condition(self) -> str:
        """Pipeline, pose and known part of the frame, in words."""
        whole = self.known == "full"
        frame = "" if whole else f", {KNOWN[self.known]} of the pose known"
        return f"{name_of_pipeline(self.pipeline)}, {POSES[self.turns]}{frame}"


@dataclass(frozen=True)
class Verdict:
    """The answer to a question by its leads.

    Attributes
    ----------
    word : {"yes", "no", "not settled"}
        ``yes`` if all leads are shown. ``no`` if no lead is shown, and each interval ends at `MARGIN` or below.
        ``not settled`` in all other cases.
    ahead, behind : tuple of Lead
        The leads that are shown: their corrected p value is below `SIGNIFICANCE`; with a mean above or below 0.
    leads : tuple of Lead
        All leads of the question.
    excluded : float, optional
        The largest upper end of the intervals: a larger lead is excluded in each condition. None if an interval is
        missing.
    """

    word: Word
    ahead: tuple[Lead, ...]
    behind: tuple[Lead, ...]
    leads: tuple[Lead, ...]
    excluded: float | None


@dataclass(frozen=True)
class KeptLeads:
    """The kept leads of a set of objects, with the days of their measurement."""

    leads: tuple[Lead, ...]
    objects: int
    dates: tuple[str, ...]

    def of(self, question: Question) -> tuple[Lead, ...]:
        """Return the leads of a question."""
        return tuple(lead for lead in self.leads if lead.name in LEADS_OF[question])

    def by_class(self) -> list[tuple[Lead, ...]]:
        """Return the leads of each pipeline in its first condition, to be shown by class."""
        conditions = dict.fromkeys((lead.pipeline, lead.condition) for lead in self.leads)
        first = dict(reversed(list(conditions)))
        return [
            tuple(lead for lead in self.leads if lead.condition == first[pipeline])
            for pipeline in dict.fromkeys(pipeline for pipeline, _ in conditions)
        ]


def name_of_pipeline(name: str) -> str:
    """Return a pipeline or the most literal variant of the paper in words."""
    return "the most literal variant" if name == "literal" else pipeline_name(name)


def read_kept_leads(intervals: IntervalParameters, name: str = LARGEST_SET) -> KeptLeads | None:
    """Read the kept leads of a set of objects; None if the package has none of the set.

    Leads of upright objects with the whole frame known are means over draws of the places, all other leads are means
    over draws of the turns. Raises `ReportError` if a kept file is damaged.
    """
    drawn, turned = read_kept().get(name), read_turned().get(name)
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
    dates = tuple(sorted({kept.date for kept in (drawn, turned) if kept is not None}))
    return KeptLeads(tuple(sorted(leads, key=_place)), max(one.objects for one in leads), dates)


def run_leads(
    metrics: Mapping[str, Any], classifiers: Mapping[str, str], turns: Turns, known: Known
) -> tuple[Lead, ...]:
    """Return the leads of a run's own objects.

    Parameters
    ----------
    metrics : mapping
        The result of `evaluation.summary.summarise`, or the content of ``reports/metrics.json``.
    classifiers : mapping of str to str
        The headline classifier of each pipeline.
    turns, known : str
        How the run turned its objects, and the known part of the frame in pipeline ``order_free``.
    """
    leads = []
    for pipeline, classifier in classifiers.items():
        found = metrics.get("leads", {}).get(pipeline, {}).get(classifier, {})
        for name in LEADS:
            if name not in found:
                continue
            compared = found[name]
            leads.append(
                Lead(
                    name,
                    pipeline,
                    turns,
                    known if pipeline == "order_free" else "full",
                    compared["draws"]["count"],
                    compared["objects"],
                    measured_figure(compared, "difference"),
                    compared["draws"]["standard_deviation"],
                )
            )
    return tuple(leads)


def verdict(leads: Iterable[Lead], over: Over = "objects") -> Verdict:
    """Answer a question for new objects or for new classes, by the rule of `Verdict`; at least one lead is needed.

    The word ``yes`` claims every lead, and the word ``no`` excludes a lead above `Verdict.excluded` in each condition:
    a claim about all conditions needs no correction for their number (R. Berger, Technometrics 24(4), 1982). Single
    leads are claimed after Holm's correction only.
    """
    leads = tuple(leads)
    evidence = [_evidence(lead, over) for lead in leads]
    adjusted = holm([p for p, _ in evidence])
    shown = [lead for lead, p in zip(leads, adjusted, strict=True) if p < SIGNIFICANCE]
    ahead = tuple(lead for lead in shown if lead.difference.mean > 0)
    behind = tuple(lead for lead in shown if lead.difference.mean < 0)
    ends = [end for _, end in evidence]
    excluded = None if None in ends else max(end for end in ends if end is not None)
    word: Word = "not settled"
    if len(ahead) == len(leads):
        word = "yes"
    elif not ahead and excluded is not None and excluded <= MARGIN:
        word = "no"
    return Verdict(word, ahead, behind, leads, excluded)


def _evidence(lead: Lead, over: Over) -> tuple[float, float | None]:
    """Return p value and upper end of a lead; 1 and None where there is no interval."""
    if over == "objects":
        return lead.p_value, lead.difference.high
    return lead.p_value_new_classes, lead.difference.new_classes_high


def lead_in_words(lead: Lead) -> str:
    """Return a lead with its intervals, such as ``+2.0 points (new objects −1.0 to +5.0, new classes −4.0 to +8.0)``."""
    return (
        f"{points(lead.difference.mean)} points {both_intervals(lead.difference, points)}".rstrip()
    )


def question_sentence(question: Question, kept: KeptLeads) -> str:
    """Answer a question by kept leads: a short sentence, and the evidence."""
    found = verdict(kept.of(question))
    said = _salience(found) if question == "salience" else _seeing(found)
    return f"{said} ({counted(kept.objects, 'object')}, measured on {listed(kept.dates)})."


def _seeing(found: Verdict) -> str:
    """Return in which poses seeing helps, and the number of comparisons in which places that are seen are ahead."""
    poses = [turns for turns in POSES if any(lead.turns == turns for lead in found.leads)]
    helped = [turns for turns in poses if any(lead.turns == turns for lead in found.ahead)]
    headline = "Seeing is not shown to help to choose places."
    if helped:
        others = [turns for turns in poses if turns not in helped]
        rest = f", and is not shown to help if they are {_poses(others)}" if others else ""
        headline = f"Seeing can help if objects are {_poses(helped)}{rest}."
    drawn = verdict(found.leads, "classes")
    return (
        f"{headline} In {len(found.ahead) or 'none'} of {counted(len(found.leads), 'comparison')} places that are seen are "
        f"ahead of random places in reach{_most(found.ahead, max)}, and in {len(found.behind) or 'none'} they are "
        f"behind{_most(found.behind, min)}; for new classes, too, they are ahead in {len(drawn.ahead) or 'none'} and behind "
        f"in {len(drawn.behind) or 'none'}"
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
    return f",{' most of all' * (len(leads) > 1)} in {most.condition} ({lead_in_words(most)})"


def _salience(found: Verdict) -> str:
    """Return in how many conditions fixations are ahead of random places in sight, and the excluded lead."""
    count = counted(len(found.leads), "condition")
    behind = ""
    if found.behind:
        behind = f"; fixations are behind in {len(found.behind)}{_most(found.behind, min)}"
    if found.ahead:
        return (
            f"Salience helps in {len(found.ahead)} of {count}. Fixations are ahead of random places in "
            f"sight{_most(found.ahead, max)}{behind}"
        )
    excluded = ""
    if found.excluded is not None:
        end = verdict(found.leads, "classes").excluded
        more = (
            ""
            if end is None
            else f"; for new classes only a lead above {percent_points(end)} points is excluded"
        )
        excluded = (
            f". A lead above {percent_points(found.excluded)} points is excluded in each{more}"
        )
    helps = (
        "Salience does not help on objects of these classes"
        if found.word == "no"
        else "Salience is not shown to help"
    )
    return f"{helps}. In none of {count} are fixations ahead of random places in sight{excluded}{behind}"


def _of_draws(kept: KeptSet) -> dict[_Condition, dict[str, _Measured]]:
    """Return the accuracies of upright objects, by condition and strategy."""
    return {
        (pipeline, "none", "full"): {
            strategy: _Measured(drawn.mean, len(drawn.draws), drawn.draws)
            for strategy, drawn in kept_accuracies(kept, pipeline).items()
        }
        for pipeline in kept.pipelines
    }


def _of_turns(kept: TurnedSet) -> dict[_Condition, dict[str, _Measured]]:
    """Return the accuracies of turned objects after `HEADLINE_TOUCHES`, by condition and strategy."""
    found: dict[_Condition, dict[str, _Measured]] = {}
    for cell in kept.cells:
        if cell.touches == HEADLINE_TOUCHES and cell.known not in _LEFT_OUT:
            mean = tested_accuracies(kept.objects, cell.accuracy, cell.weights)
            by_strategy = found.setdefault((cell.pipeline, cell.turns, cell.known), {})
            by_strategy[cell.strategy] = _Measured(mean, cell.draws)
    return found


def _lead(
    name: LeadName,
    condition: _Condition,
    first: _Measured,
    second: _Measured,
    intervals: IntervalParameters,
) -> Lead:
    """Compute a lead; the objects that both strategies tested are not empty."""
    plus, minus = in_common(first.mean, second.mean)
    compared = compare_paired(plus.accuracy, minus.accuracy, plus.weights, intervals, plus.classes)
    categories = np.array(plus.classes)
    by_class = {}
    for category in np.unique(categories).tolist():
        rows = categories == category
        of_class = compare_paired(
            plus.accuracy[rows], minus.accuracy[rows], plus.weights[rows], intervals
        )
        by_class[category] = estimate(of_class.difference)
    over_draws = lead_over_draws(first.mean, second.draws) if second.draws else None
    return Lead(
        name,
        *condition,
        second.count,
        len(plus.objects),
        lead_figure(compared),
        over_draws.standard_deviation if over_draws else 0.0,
        by_class,
    )


def _place(lead: Lead) -> tuple[int, ...]:
    """Return a sorting key: the paper's pipeline first, upright first, from all to nothing known."""
    return (
        _PIPELINES.index(lead.pipeline),
        list(POSES).index(lead.turns),
        list(KNOWN).index(lead.known),
        list(LEADS).index(lead.name),
    )
