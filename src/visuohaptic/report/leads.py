"""The leads of one way to choose places over another, and the rule by which they answer a question of the experiment."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from visuohaptic.evaluation.intervals import SIGNIFICANCE, holm
from visuohaptic.evaluation.leads import LEADS, LeadName
from visuohaptic.geometry.turning import Turns
from visuohaptic.recognition.parameters import Frame
from visuohaptic.report.estimates import Estimate
from visuohaptic.report.estimates import measured as measured_figure
from visuohaptic.report.wording import POSES, pipeline_name

MARGIN = 0.05
"""The largest lead, as a share, that an answer ``no`` may leave open: a lead of five points."""

Word = Literal["yes", "no", "not settled"]

Over = Literal["objects", "classes"]
"""Whether an interval is for new objects of the same classes, or for new classes."""

PLACES: Mapping[str, str] = {
    "fixation": "fixations",
    "random": "random places in reach",
    "random_visible": "random places in sight",
}
"""The places of the compared strategies, in words."""

KNOWN: Mapping[Frame, str] = {
    "full": "all",
    "vertical": "centre and vertical",
    "centre": "centre",
    "none": "nothing",
}
"""The known part of the objects' frame, `recognition.frame`, in words."""


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
    difference : Estimate
        The lead as a share, with intervals and p values for new objects of the same classes and for new classes.
    deviation : float
        The standard deviation over draws, as a share; 0 for a single draw.
    """

    name: LeadName
    pipeline: str
    turns: Turns
    known: Frame
    draws: int
    objects: int
    difference: Estimate
    deviation: float = 0.0

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


def name_of_pipeline(name: str) -> str:
    """Return a pipeline or the most literal variant of the paper in words."""
    return "the most literal variant" if name == "literal" else pipeline_name(name)


def run_leads(
    metrics: Mapping[str, Any], classifiers: Mapping[str, str], turns: Turns, known: Frame
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
