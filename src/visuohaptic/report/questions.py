"""The experiment's questions, each with an estimate, its interval and what the interval excludes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from visuohaptic.geometry.turning import Turns
from visuohaptic.report.comparison import REFERENCE, Comparison, PipelineTable
from visuohaptic.report.estimates import Figure, with_interval
from visuohaptic.report.turned import POSES
from visuohaptic.report.variants import VariantsSummary, Verdict
from visuohaptic.report.wording import (
    counted,
    percent,
    percent_points,
    pipeline_name,
    points,
    titled,
)

GAIN = 0.02
"""A gain, as a share, that is worth having."""
MARGIN = 0.05
"""A difference from a published accuracy, as a share, that still counts as the same."""

MAIN_OPPONENT = "random"
REASONS: Mapping[Verdict, str] = {
    "yes": "ahead in the default and the most literal variant",
    "no": "no gain in the default or the literal variant",
    "depends": "it depends on how the paper is read",
    "not shown": "no variant of the paper settles it",
}
"""Why fixation leads or not, by the rule in studies/variants/README.md."""


@dataclass(frozen=True)
class Answer:
    """A question of the experiment, and what its tables say.

    Attributes
    ----------
    question : str
        The question.
    finding : str
        The answer in a few words.
    number : str
        The figure that the finding rests on, with its interval.
    sentence : str
        The rest of the sentence: of what, of which objects, and what the interval excludes.
    link : str
        The anchor of the section that shows more.
    beside : tuple of str
        Sentences on more objects, from kept measurements, or on what the figure takes for granted.
    rule : str
        The verdict by a rule that was written down before the measurement, and the rule.
    recount : str
        Lines of Python that print the number.
    """

    question: str
    finding: str
    number: str
    sentence: str
    link: str
    beside: tuple[str, ...] = ()
    rule: str = ""
    recount: str = ""


def recognition_answer(
    tables: Sequence[PipelineTable],
    classes: int,
    touches: int,
    unseen: str,
    turns: Turns = "none",
    beside: Sequence[str] = (),
) -> Answer:
    """Answer whether objects can be recognised by touch.

    Parameters
    ----------
    tables : sequence of PipelineTable
        The pipelines of the run.
    classes, touches : int
        The number of classes, and of touches in a sequence.
    unseen : str
        What training did not contain, such as ``unseen objects``.
    turns : {"none", "vertical", "any"}
        How the run turned its objects.
    beside : sequence of str
        Sentences on other objects.

    Returns
    -------
    Answer
        Yes, if the interval of every pipeline lies above chance; no, if each excludes `GAIN` above chance.
    """
    found = [table.headline.accuracy[table.leading] for table in tables]
    chance = 1 / classes
    finding = "Not shown"
    if all(figure.low is not None and figure.low > chance for figure in found):
        finding = "Yes"
    elif all(figure.high is not None and figure.high < chance + GAIN for figure in found):
        finding = "No"
    others = [
        f"{with_interval(figure, percent)} by our own {pipeline_name(table.name)}"
        for table, figure in zip(tables[1:], found[1:], strict=True)
    ]
    first = tables[0]
    return Answer(
        "Can an object be recognised by touch?",
        finding,
        with_interval(found[0], percent),
        f"of {touches}-touch sequences of {unseen} are correctly classified by {pipeline_name(first.name)} "
        f"({first.headline.name}, {counted(first.objects, 'object')}); "
        f"{', '.join([*others, f'guessing gives {percent(chance, 0)}'])}.",
        "comparison",
        beside=(f"Objects are {POSES[turns]}, in training and test.", *beside),
        rule="Rule: yes if the interval of every pipeline lies above guessing; no if every interval excludes a "
        f"gain of {points(GAIN)} points over guessing.",
    )


def fixation_answer(
    tables: Sequence[PipelineTable], variants: VariantsSummary, beside: Sequence[str] = ()
) -> Answer | None:
    """Answer whether fixations lead random touches in reach; None without such touches.

    Only an interval that excludes 0 gives the lead a sign. `beside` are sentences on other objects.
    """
    compared = [
        (table, table.headline.comparisons[MAIN_OPPONENT])
        for table in tables
        if has_opponent(table)
    ]
    if not compared:
        return None
    (first, main), *others = compared
    further = [
        f" {titled(pipeline_name(table.name))}: {with_interval(found.difference, points, ' points')}."
        for table, found in others
    ]
    return Answer(
        "Does it help to touch where the eye would fixate?",
        _lead_finding(main.difference, main.objects),
        with_interval(main.difference, points, " points"),
        f"is the lead of fixation over random places in reach of the sensor, in {pipeline_name(first.name)}"
        f"{_over_draws(main)}.{_excluded(main.difference)}{''.join(further)}",
        "comparison",
        beside=tuple(beside),
        rule=f"By the rule for all variants of the paper (studies/variants): {variants.verdict}, "
        f"{REASONS[variants.verdict]}. {variants_sentence(variants)}".rstrip(),
    )


def _lead_finding(lead: Figure, objects: int) -> str:
    if lead.low is not None and lead.low > 0:
        return "Yes, on these objects"
    if lead.high is not None and lead.high < 0:
        return "No, on these objects random touches lead"
    return f"Not settled by {counted(objects, 'object')}"


def _excluded(lead: Figure) -> str:
    """Say which leads an interval excludes that holds 0."""
    if lead.low is None or lead.high is None or not lead.low <= 0 <= lead.high:
        return ""
    return (
        f" Leads above {points(lead.high).lstrip('+')} points and lags beyond "
        f"{points(-lead.low).lstrip('+')} are excluded."
    )


def _over_draws(compared: Comparison) -> str:
    """Say how many draws of random places a lead is the mean of, and how far a draw moves it; empty with a single draw."""
    if compared.draws is None:
        return ""
    spread = percent_points(compared.draws.standard_deviation)
    return (
        f" (mean of {compared.draws.count} draws of the places; a single draw varies by ±{spread})"
    )


def reproduction_answer(table: PipelineTable) -> Answer | None:
    """Answer whether the published accuracies are found again; None where none is comparable.

    A published accuracy is found again if the whole interval of the accuracy here lies within `MARGIN`
    of it, and not found if the whole interval lies farther away; otherwise nothing is shown.
    """
    gaps = [
        _gap(row.accuracy[strategy], published)
        for row in table.rows
        for strategy, published in row.published.items()
        if strategy in row.accuracy
    ]
    if not gaps:
        return None
    within, outside = gaps.count("within"), gaps.count("outside")
    row = table.headline
    number = against = ""
    if table.leading in row.published:
        here, published = row.accuracy[table.leading], row.published[table.leading]
        number = with_interval(here, percent)
        against = f"here, {percent(published, 2)} published ({row.name}). "
    margin = f"{100 * MARGIN:.0f} points"
    finding = "Not settled"
    if within == len(gaps):
        finding = f"Yes, within {margin}"
    elif outside:
        finding = f"No for {outside} of {len(gaps)} accuracies"
    return Answer(
        "Is the paper reproduced?",
        finding,
        number,
        f"{against}Of {len(gaps)} published accuracies {outside} lie more than {margin} outside our intervals. For "
        f"{within} our whole interval lies within {margin}. {len(gaps) - within - outside} are not settled. Our "
        "objects are not those of the paper.",
        "comparison",
        rule=f"Rule: a published accuracy is found again if the whole interval here lies within {margin} of it. "
        "A wide interval that contains it shows nothing.",
    )


def _gap(here: Figure, published: float) -> Literal["within", "outside", "not shown"]:
    if here.low is None or here.high is None:
        return "not shown"
    low, high = here.low - published, here.high - published
    if low >= -MARGIN and high <= MARGIN:
        return "within"
    return "outside" if low > MARGIN or high < -MARGIN else "not shown"


def variants_sentence(variants: VariantsSummary) -> str:
    """Say in how many variants of the paper fixation is ahead, by set; empty without variants."""
    if not variants.spread:
        return ""
    found = [
        f"on {one.objects} objects in {one.ahead} of {one.variants} variants, and behind in {one.behind}"
        for one in variants.spread
    ]
    return (
        "The paper leaves steps open, so it was read in many ways. Fixations are significantly ahead of "
        f"random touches {'; '.join(found)}."
    )


def variant_sentences(variants: VariantsSummary) -> list[str]:
    """Say how far fixations lead in the default and the most literal variant on the largest measured set."""
    objects = max((lead.objects for lead in variants.leads), default=0)
    found = {
        (lead.variant, lead.opponent): Figure(lead.difference, lead.low, lead.high)
        for lead in variants.leads
        if lead.objects == objects
    }
    reach, seen, literal = (
        found.get(key)
        for key in (("default", "reachable"), ("default", "visible"), ("literal", "reachable"))
    )
    if reach is None or seen is None or literal is None:
        return []
    when = f"measured on {variants.source.date}" if variants.source else "in this run"
    return [
        (
            f"{objects} objects chose how the paper's open steps are read here, which may raise the lead on them ({when}): "
            f"{with_interval(reach, points, ' points')} over random places in reach, and "
            f"{with_interval(seen, points, ' points')} over random places in sight, on the side that the eye sees."
        ),
        (
            f"Under the most literal reading of the paper the lead on them is "
            f"{with_interval(literal, points, ' points')} over random places in reach."
        ),
    ]


def has_opponent(table: PipelineTable) -> bool:
    """Return whether the answers' classifier was tried by fixation and by random touches in reach."""
    return table.leading == REFERENCE and MAIN_OPPONENT in table.headline.comparisons
