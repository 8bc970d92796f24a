"""The experiment's questions, each with an estimate, its interval, and a verdict by a rule."""

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
"""The smallest relevant gain, as a share."""
MARGIN = 0.05
"""The largest difference from a published accuracy, as a share, that counts as reproduced."""

MAIN_OPPONENT = "random"
REASONS: Mapping[Verdict, str] = {
    "yes": "ahead in the default and the most literal variant",
    "no": "no gain in the default or the literal variant",
    "depends": "it depends on how the paper is read",
    "not shown": "no variant of the paper settles it",
}
"""The reason for each verdict on the lead of fixation, by the rule in studies/variants/README.md."""


@dataclass(frozen=True)
class Answer:
    """A question of the experiment, and the answer from its tables.

    Attributes
    ----------
    question : str
        The question.
    finding : str
        The answer in a few words.
    number : str
        The figure behind the finding, with its interval.
    sentence : str
        The sentence after the number: the quantity, the objects, and differences that the interval excludes.
    link : str
        The anchor of the section that shows more.
    beside : tuple of str
        Sentences on more objects, from kept measurements, or on assumptions behind the figure.
    rule : str
        The rule, which was written before the measurement, or the verdict by the rule.
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
    """Return the answer to the question whether objects can be recognised by touch.

    Parameters
    ----------
    tables : sequence of PipelineTable
        The pipelines of the run.
    classes, touches : int
        The number of classes, and the number of touches per sequence.
    unseen : str
        The name of test data that training does not contain, such as ``unseen objects``.
    turns : {"none", "vertical", "any"}
        How the run turned its objects.
    beside : sequence of str
        Sentences on other objects.

    Returns
    -------
    Answer
        Yes, if the interval of every pipeline lies above chance; no, if every interval lies below chance plus `GAIN`.
    """
    accuracies = [table.headline.accuracy[table.leading] for table in tables]
    chance = 1 / classes
    finding = "Not shown"
    if all(figure.low is not None and figure.low > chance for figure in accuracies):
        finding = "Yes"
    elif all(figure.high is not None and figure.high < chance + GAIN for figure in accuracies):
        finding = "No"
    others = [
        f"{with_interval(figure, percent)} by our own {pipeline_name(table.name)}"
        for table, figure in zip(tables[1:], accuracies[1:], strict=True)
    ]
    first = tables[0]
    return Answer(
        "Can an object be recognised by touch?",
        finding,
        with_interval(accuracies[0], percent),
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
    """Return the answer to the question whether fixations lead random touches in reach.

    None if no pipeline has both strategies. Only an interval that excludes 0 gives the lead a sign. `beside` are
    sentences on other objects.
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
        f" {titled(pipeline_name(table.name))}: {with_interval(comparison.difference, points, ' points')}."
        for table, comparison in others
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
    """Return a sentence on the leads that an interval around 0 excludes; empty for other intervals."""
    if lead.low is None or lead.high is None or not lead.low <= 0 <= lead.high:
        return ""
    return (
        f" Leads above {points(lead.high).lstrip('+')} points and lags beyond "
        f"{points(-lead.low).lstrip('+')} are excluded."
    )


def _over_draws(compared: Comparison) -> str:
    """Return the number of draws behind a lead and their spread in brackets; empty with a single draw."""
    if compared.draws is None:
        return ""
    spread = percent_points(compared.draws.standard_deviation)
    return f" (mean of {compared.draws.count} draws of the places; standard deviation over draws {spread} points)"


def reproduction_answer(table: PipelineTable) -> Answer | None:
    """Return the answer to the question whether the published accuracies are reproduced.

    None if no published accuracy is comparable. An accuracy is reproduced if the whole interval here lies within
    `MARGIN` of the published value. It is not reproduced if the whole interval lies outside. Otherwise it is not
    settled.
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
        f"{against}Of {len(gaps)} published accuracies {outside} lie more than {margin} outside our intervals, {within} "
        f"are reproduced within {margin}, and {len(gaps) - within - outside} are not settled. Our "
        "objects differ from the paper's objects.",
        "comparison",
        rule=f"Rule: a published accuracy is reproduced if the whole interval here lies within {margin} of it. "
        "A wide interval around it does not settle the question.",
    )


def _gap(here: Figure, published: float) -> Literal["within", "outside", "not shown"]:
    if here.low is None or here.high is None:
        return "not shown"
    low, high = here.low - published, here.high - published
    if low >= -MARGIN and high <= MARGIN:
        return "within"
    return "outside" if low > MARGIN or high < -MARGIN else "not shown"


def variants_sentence(variants: VariantsSummary) -> str:
    """Return a sentence on the number of variants of the paper with fixation ahead, by set; empty without variants."""
    if not variants.spread:
        return ""
    counts = [
        f"on {spread.objects} objects in {spread.ahead} of {spread.variants} variants, and behind in {spread.behind}"
        for spread in variants.spread
    ]
    return (
        "The paper leaves steps open, so many variants of it were run. Fixations are significantly ahead of "
        f"random touches {'; '.join(counts)}."
    )


def variant_sentences(variants: VariantsSummary) -> list[str]:
    """Return sentences on the lead of fixations in the default and the most literal variant.

    The leads are those on the largest measured set. Empty if one of them is missing.
    """
    objects = max((lead.objects for lead in variants.leads), default=0)
    leads = {
        (lead.variant, lead.opponent): Figure(lead.difference, lead.low, lead.high)
        for lead in variants.leads
        if lead.objects == objects
    }
    reach, visible, literal = (
        leads.get(key)
        for key in (("default", "reachable"), ("default", "visible"), ("literal", "reachable"))
    )
    if reach is None or visible is None or literal is None:
        return []
    when = f"measured on {variants.source.date}" if variants.source else "in this run"
    return [
        (
            f"The default for the paper's open steps was chosen on {objects} objects, which may raise the lead there. "
            f"On these objects the lead is {with_interval(reach, points, ' points')} over random places in reach, and "
            f"{with_interval(visible, points, ' points')} over random places in sight, on the side that the eye sees "
            f"({when})."
        ),
        (
            f"In the most literal variant of the paper the lead on these objects is "
            f"{with_interval(literal, points, ' points')} over random places in reach."
        ),
    ]


def has_opponent(table: PipelineTable) -> bool:
    """Return whether the headline classifier has figures by fixation and by random touches in reach."""
    return table.leading == REFERENCE and MAIN_OPPONENT in table.headline.comparisons
