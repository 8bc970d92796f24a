"""The experiment's questions; each answer has an estimate with its interval, and the rule of its finding."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from visuohaptic.evaluation.leads import LEADS, LEADS_OF, Question
from visuohaptic.geometry.turning import Turns
from visuohaptic.report.comparison import REFERENCE, PipelineTable
from visuohaptic.report.estimates import Figure, with_interval
from visuohaptic.report.leads import (
    MARGIN as LARGEST_NO,
)
from visuohaptic.report.leads import (
    PLACES,
    SIGNIFICANCE,
    KeptLeads,
    Lead,
    Word,
    lead_in_words,
    name_of_pipeline,
    question_sentence,
    verdict,
)
from visuohaptic.report.turned import POSES
from visuohaptic.report.variants import Spread, VariantsSummary
from visuohaptic.report.wording import (
    counted,
    listed,
    percent,
    percent_points,
    pipeline_name,
    probability,
    strategy_name,
    titled,
)

GAIN = 0.02
"""The smallest relevant gain of accuracy, as a share."""
MARGIN = 0.05
"""The largest difference from a published accuracy, as a share, that counts as reproduced."""

MAIN_OPPONENT = "random"
"""The strategy of the second question: random touches in reach of the sensor."""


@dataclass(frozen=True)
class Answer:
    """A question of the experiment, and the parts of its answer in the order of the page.

    Attributes
    ----------
    question : str
        The question.
    finding : str
        The answer in a few words.
    number : str
        The figure behind the finding, with its interval; empty without a figure.
    sentence : str
        The rest of the sentence that begins with `number`, and further sentences of the same paragraph.
    link : str
        The anchor of the section that shows more.
    beside : tuple of str
        Further sentences, one paragraph each: assumptions behind the figure, and measurements on other objects.
    rule : str
        Sentences on the rule that decides the finding.
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

    Accuracies are of each pipeline's headline classifier with the leading strategy, usually fixations.

    Parameters
    ----------
    tables : sequence of PipelineTable
        The pipelines of the run, at least one. The number of the answer is the accuracy of the first pipeline.
    classes, touches : int
        The number of classes, and the number of touches per sequence.
    unseen : str
        The test data in words, such as ``unseen objects``.
    turns : {"none", "vertical", "any"}
        How the run turned its objects.
    beside : sequence of str
        Further sentences for `Answer.beside`.

    Returns
    -------
    Answer
        Finding ``Yes`` if the whole interval of every pipeline lies above chance, which is 1 / `classes`. ``No`` if
        every interval ends below chance plus `GAIN`. ``Not shown`` in all other cases, also if an interval is missing.
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
        rule="Rule: yes if the whole interval of every pipeline lies above guessing; no if every interval ends less "
        f"than {100 * GAIN:.0f} points above guessing; not shown in all other cases.",
    )


FINDINGS: Mapping[Word, str] = {
    "yes": "Yes, on these objects",
    "no": "No",
    "not settled": "Not settled",
}
"""The finding of a run's own leads, by the word of their verdict."""

QUESTIONS: Mapping[Question, str] = {
    "seeing": "Does seeing help to choose places?",
    "salience": "Does salience help, given that one sees?",
}
"""The two questions in words."""

RULES: Mapping[Question, str] = {
    "seeing": "Fixations and random places in sight of the eye are compared with random places in reach of the sensor, "
    "which need no eye.",
    "salience": "Fixations are compared with random places in sight: the eye is the same, only salience is missing.",
}
"""What each question compares."""


def lead_answer(question: Question, leads: Sequence[Lead], kept: KeptLeads | None) -> Answer:
    """Return the answer to one of the two questions by a run's own leads, with one sentence on more objects.

    Parameters
    ----------
    question : {"seeing", "salience"}
        The question.
    leads : sequence of Lead
        The leads of the run, of all questions, the paper's pipeline first. Without a lead of the question, the answer
        says what the run lacks.
    kept : KeptLeads, optional
        Leads of more objects that are kept with the package.

    Returns
    -------
    Answer
        The finding follows the word of `leads.verdict`. The number is the first lead of the question.
    """
    beside = (question_sentence(question, kept),) if kept is not None else ()
    own = [lead for lead in leads if lead.name in LEADS_OF[question]]
    missing = {name for lead in LEADS_OF[question] for name in LEADS[lead]}
    rule = (
        f"{RULES[question]} Rule: yes if each lead is ahead with p below {SIGNIFICANCE:g} after Holm's correction; no if "
        f"none is, and each interval ends at {100 * LARGEST_NO:.0f} points or below; not settled in all other cases."
    )
    if not own:
        strategies = listed([f"`{name}`" for name in PLACES if name in missing])
        return Answer(
            QUESTIONS[question],
            "This run can't say",
            "",
            f"it lacks touches by {'two of ' if len(missing) > 2 else ''}{strategies} (`probing.strategies`).",
            "comparison",
            beside=beside,
            rule=rule,
        )
    found = verdict(own)
    first, *others = own
    plus, minus = first.places
    finding = FINDINGS[found.word]
    if found.word == "not settled":
        finding = f"{finding} by {counted(first.objects, 'object')}"
    further = "".join(
        f" {titled(_other(lead, first))}: {lead_in_words(lead)}{_over_draws(lead)}."
        for lead in others
    )
    excluded = ""
    if found.excluded is not None and not found.ahead:
        excluded = f" A lead above {percent_points(found.excluded)} points is excluded{' in each' if others else ''}."
    return Answer(
        QUESTIONS[question],
        finding,
        lead_in_words(first),
        f"is the lead of {plus} over {minus} in {name_of_pipeline(first.pipeline)}{_over_draws(first)}.{further}{excluded}",
        "comparison",
        beside=beside,
        rule=rule,
    )


def _other(lead: Lead, first: Lead) -> str:
    """Return in words how a lead differs from the first lead: its places, its pipeline, or both."""
    pipeline = name_of_pipeline(lead.pipeline)
    if lead.name == first.name:
        return pipeline
    return f"{lead.places[0]}, {pipeline}"


def _over_draws(lead: Lead) -> str:
    """Return, in brackets, the number of draws of random places and the standard deviation of the lead over draws."""
    if lead.draws < 2:
        return " (one draw of the places)"
    spread = percent_points(lead.deviation)
    return f" (mean of {lead.draws} draws of the places; standard deviation over draws {spread} points)"


def reproduction_answer(table: PipelineTable) -> Answer | None:
    """Return the answer to the question whether a pipeline reproduces the published accuracies.

    All classifiers and strategies with a published accuracy count. A published accuracy is reproduced if the whole
    interval of the run's accuracy lies within `MARGIN` of it, and not reproduced if the whole interval lies further
    away. All others are not settled.

    Returns
    -------
    Answer or None
        Finding ``Yes`` if all published accuracies are reproduced, ``No for n of m accuracies`` if n > 0 are not
        reproduced, else ``Not settled``. None without a published accuracy.
    """
    closeness = [
        _closeness(row.accuracy[strategy], published)
        for row in table.rows
        for strategy, published in row.published.items()
        if strategy in row.accuracy
    ]
    if not closeness:
        return None
    within, outside = closeness.count("within"), closeness.count("outside")
    row = table.headline
    number = against = ""
    if table.leading in row.published:
        here, published = row.accuracy[table.leading], row.published[table.leading]
        number = with_interval(here, percent)
        against = f"here, {percent(published, 2)} published ({row.name}, {strategy_name(table.leading)}). "
    margin = f"{100 * MARGIN:.0f} points"
    finding = "Not settled"
    if within == len(closeness):
        finding = f"Yes, within {margin}"
    elif outside:
        finding = f"No for {outside} of {len(closeness)} accuracies"
    return Answer(
        "Is the paper reproduced?",
        finding,
        number,
        f"{against}Of {len(closeness)} published accuracies {within} are reproduced, {outside} are not (our whole interval "
        f"is more than {margin} away), and {len(closeness) - within - outside} are not settled. Our objects differ from "
        "the paper's objects.",
        "comparison",
        rule=f"Rule: a published accuracy is reproduced if our whole interval lies within {margin} of it, and not "
        f"reproduced if our whole interval is more than {margin} away. All others are not settled.",
    )


def _closeness(here: Figure, published: float) -> Literal["within", "outside", "not settled"]:
    """Return whether the whole interval lies within `MARGIN` of a published accuracy, or entirely outside."""
    if here.low is None or here.high is None:
        return "not settled"
    low, high = here.low - published, here.high - published
    if low >= -MARGIN and high <= MARGIN:
        return "within"
    return "outside" if low > MARGIN or high < -MARGIN else "not settled"


def variant_counts_sentence(variants: VariantsSummary) -> str:
    """Return sentences with the number of variants in which fixations are ahead or behind with p below 0.05.

    The numbers are per set of objects, of each variant tested by itself and after Holm's correction. Empty without
    variants.
    """
    if not variants.spread:
        return ""
    singly = [
        f"in {spread.ahead} of {spread.variants} variants on {spread.objects} objects (behind in {spread.behind})"
        for spread in variants.spread
    ]
    corrected = [
        f"ahead in {spread.ahead_holm} and behind in {spread.behind_holm} of the {spread.variants} on {spread.objects} "
        f"objects{_why_none(spread)}"
        for spread in variants.spread
    ]
    return (
        "The paper leaves steps open, so many variants of it were run. Fixations are ahead of random touches with p below "
        f"{SIGNIFICANCE:g}, each variant tested by itself, {listed(singly)}. After Holm's correction for the number of "
        f"variants they are {listed(corrected)}."
    )


def _why_none(spread: Spread) -> str:
    """Return a note, in brackets, if the sign changes of so few objects allow no p value that Holm's correction keeps."""
    smallest = 2.0 ** (1 - spread.objects)
    if spread.variants * smallest < SIGNIFICANCE:
        return ""
    return f" (the smallest p value of so few objects, {probability(smallest)}, is too large)"


def has_opponent(table: PipelineTable) -> bool:
    """Return whether a pipeline's headline classifier has a comparison of fixations with `MAIN_OPPONENT`."""
    return table.leading == REFERENCE and MAIN_OPPONENT in table.headline.comparisons
