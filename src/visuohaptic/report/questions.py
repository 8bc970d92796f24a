"""The experiment's questions; each answer has an estimate with its interval, and the rule of its finding."""

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
    listed,
    percent,
    percent_points,
    pipeline_name,
    points,
    strategy_name,
    titled,
)

GAIN = 0.02
"""The smallest relevant gain of accuracy, as a share."""
MARGIN = 0.05
"""The largest difference from a published accuracy, as a share, that counts as reproduced."""

MAIN_OPPONENT = "random"
"""The strategy of the second question: random touches in reach of the sensor."""

REASONS: Mapping[Verdict, str] = {
    "yes": "fixations lead in the default and the most literal variant, on the paper's objects and on others",
    "no": f"the default and the most literal variant exclude a gain of {100 * GAIN:.0f} points, on the paper's objects "
    "and on others",
    "depends": "fixations are significantly ahead in some variants and significantly behind in others",
    "not shown": "the variants show neither a lead nor its absence",
}
"""The reason for each verdict on the lead of fixations, by the rule in studies/variants/README.md."""


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
        Sentences on the rule that decides the finding. For the lead of fixations, the verdict of all variants follows.
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


def fixation_answer(
    tables: Sequence[PipelineTable], variants: VariantsSummary, beside: Sequence[str] = ()
) -> Answer | None:
    """Return the answer to the question whether fixations are more accurate than random touches in reach of the sensor.

    Parameters
    ----------
    tables : sequence of PipelineTable
        The pipelines of the run. The number of the answer is the lead in the first pipeline that has both strategies.
    variants : VariantsSummary
        The verdict of all variants of the paper, for `Answer.rule`.
    beside : sequence of str
        Further sentences for `Answer.beside`.

    Returns
    -------
    Answer or None
        Finding ``Yes`` if the whole interval of the lead lies above 0, ``No`` if it lies below 0, else ``Not
        settled``. None if no pipeline has both strategies.
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
        f" {titled(pipeline_name(table.name))}: {with_interval(comparison.difference, points, ' points')}"
        f"{'' if comparison.draws else ', one draw of the places'}."
        for table, comparison in others
    ]
    return Answer(
        "Does it help to touch where the eye would fixate?",
        _lead_finding(main.difference, main.objects),
        with_interval(main.difference, points, " points"),
        "is the lead of fixation (accuracy by fixation minus accuracy by random places in reach of the sensor) in "
        f"{pipeline_name(first.name)}"
        f"{_over_draws(main)}.{_excluded(main.difference)}{''.join(further)}",
        "comparison",
        beside=tuple(beside),
        rule="Rule: the lead is settled only if its interval excludes 0. "
        f"Verdict by the rule for all variants of the paper (studies/variants): {variants.verdict} "
        f"({REASONS[variants.verdict]}). {variant_counts_sentence(variants)}".rstrip(),
    )


def _lead_finding(lead: Figure, objects: int) -> str:
    """Return the finding on a lead; only an interval that excludes 0 settles its sign."""
    if lead.low is not None and lead.low > 0:
        return "Yes, on these objects"
    if lead.high is not None and lead.high < 0:
        return "No, on these objects random touches lead"
    return f"Not settled by {counted(objects, 'object')}"


def _excluded(lead: Figure) -> str:
    """Return a sentence on the leads outside an interval that contains 0; empty for all other intervals."""
    if lead.low is None or lead.high is None or not lead.low <= 0 <= lead.high:
        return ""
    return (
        f" The interval excludes a lead above {points(lead.high).lstrip('+')} points and a lead below "
        f"{points(lead.low)} points."
    )


def _over_draws(compared: Comparison) -> str:
    """Return, in brackets, the number of draws and the standard deviation of the lead; empty without further draws."""
    if compared.draws is None:
        return ""
    spread = percent_points(compared.draws.standard_deviation)
    return f" (mean of {compared.draws.count} draws of the places; standard deviation over draws {spread} points)"


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
    """Return sentences with the number of variants in which fixations are significantly ahead or behind.

    The numbers are per set of objects. Empty without variants.
    """
    if not variants.spread:
        return ""
    counts = [
        f"in {spread.ahead} of {spread.variants} variants on {spread.objects} objects (significantly behind in "
        f"{spread.behind})"
        for spread in variants.spread
    ]
    return (
        "The paper leaves steps open, so many variants of it were run. Fixations are significantly ahead of "
        f"random touches {listed(counts)}."
    )


def variant_leads_sentences(variants: VariantsSummary) -> list[str]:
    """Return sentences on the lead of fixations in the default and in the most literal variant of the paper.

    The leads are those on the largest set of objects in `variants.leads`. The default's leads are over random places
    in reach and in sight, the literal variant's lead is over random places in reach. The list is empty if one of these
    three leads is missing.
    """
    objects = max((lead.objects for lead in variants.leads), default=0)
    of_objects = [lead for lead in variants.leads if lead.objects == objects]
    leads = {
        (lead.variant, lead.opponent): Figure(lead.difference, lead.low, lead.high)
        for lead in of_objects
    }
    reach, visible, literal = (
        leads.get(key)
        for key in (("default", "reachable"), ("default", "visible"), ("literal", "reachable"))
    )
    if reach is None or visible is None or literal is None:
        return []
    date = of_objects[0].date
    when = f"measured on {date}" if date else "in this run"
    return [
        (
            f"The paper leaves steps open. We chose the default for these steps on {objects} objects, and this choice may "
            f"raise the lead on these objects. On the {objects} objects the lead of the default is "
            f"{with_interval(reach, points, ' points')} over random places in reach, and "
            f"{with_interval(visible, points, ' points')} over random places on the side that the eye sees (in sight) "
            f"({when})."
        ),
        (
            f"In the most literal variant of the paper the lead on the {objects} objects is "
            f"{with_interval(literal, points, ' points')} over random places in reach."
        ),
    ]


def has_opponent(table: PipelineTable) -> bool:
    """Return whether a pipeline's headline classifier has a comparison of fixations with `MAIN_OPPONENT`."""
    return table.leading == REFERENCE and MAIN_OPPONENT in table.headline.comparisons
