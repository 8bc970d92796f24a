"""The experiment's questions; each answer has an estimate with its interval, and the rule of its finding."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from visuohaptic.evaluation.intervals import SIGNIFICANCE
from visuohaptic.evaluation.leads import LEADS_OF, Question
from visuohaptic.geometry.turning import Turns
from visuohaptic.report.comparison import REFERENCE, PipelineTable
from visuohaptic.report.estimates import Estimate, both_intervals, with_interval
from visuohaptic.report.leads import (
    MARGIN as LARGEST_NO,
)
from visuohaptic.report.leads import (
    PLACES,
    Lead,
    Word,
    name_of_pipeline,
    verdict,
)
from visuohaptic.report.wording import (
    POSES,
    counted,
    listed,
    percent,
    percent_points,
    pipeline_name,
    points,
    strategy_name,
)

GAIN = 0.02
"""The smallest relevant gain of accuracy, as a share."""
MARGIN = 0.05
"""The largest difference from a published accuracy, as a share, that counts as reproduced: the margin of equivalence."""

MAIN_OPPONENT = "random"
"""The strategy of the second question: random touches in reach of the sensor."""


@dataclass(frozen=True)
class Answer:
    """A question of the experiment, and the parts of its answer in the order of the page.

    Attributes
    ----------
    question : str
    finding : str
        The answer in a few words.
    number : str
        The figure behind the finding, with its interval; empty without a figure.
    sentence : str
        The rest of the sentence that begins with `number`, and further sentences of the same paragraph.
    link : str
        The anchor of the section that shows more.
    caveats : tuple of str
        Further sentences, one paragraph each: assumptions behind the figure.
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
    caveats: tuple[str, ...] = ()
    rule: str = ""
    recount: str = ""


def recognition_answer(
    tables: Sequence[PipelineTable],
    classes: int,
    touches: int,
    unseen: str,
    turns: Turns = "none",
    caveats: Sequence[str] = (),
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
    caveats : sequence of str
        Further sentences for `Answer.caveats`.

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
        f"{percent(figure.mean)} {both_intervals(figure, percent)}".rstrip()
        + f" by our own {pipeline_name(table.name)}"
        for table, figure in zip(tables[1:], accuracies[1:], strict=True)
    ]
    first = tables[0]
    return Answer(
        "Can an object be recognised by touch?",
        finding,
        percent(accuracies[0].mean),
        f"{both_intervals(accuracies[0], percent)} of {touches}-touch sequences of {unseen} are correctly classified by {pipeline_name(first.name)} "
        f"({first.headline.name}, {counted(first.objects, 'object')}); "
        f"{', '.join([*others, f'guessing gives {percent(chance, 0)}'])}.".lstrip(),
        "comparison",
        caveats=(f"Objects are {POSES[turns]}, in training and test.", *caveats),
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


NEEDS: Mapping[Question, str] = {
    "seeing": f"{PLACES['random']}, and at {PLACES['fixation']} or {PLACES['random_visible']}",
    "salience": f"{PLACES['fixation']} and {PLACES['random_visible']}",
}
"""The places that a run must touch to answer each question."""


def lead_answer(question: Question, leads: Sequence[Lead]) -> Answer:
    """Return the answer to one of the two questions by a run's own leads.

    Parameters
    ----------
    question : {"seeing", "salience"}
    leads : sequence of Lead
        The leads of the run, of all questions, the paper's pipeline first. Without a lead of the question, the answer
        says which touches the answer needs.

    Returns
    -------
    Answer
        The finding follows the word of `leads.verdict`. The number is the first lead of the question.
    """
    own = [lead for lead in leads if lead.name in LEADS_OF[question]]
    rule = (
        f"{RULES[question]} Rule: yes if each lead is ahead with p below {SIGNIFICANCE:g} after Holm's correction; no if "
        f"none is, and each interval ends at {100 * LARGEST_NO:.0f} points or below; not settled in all other cases."
    )
    if not own:
        return Answer(
            QUESTIONS[question],
            "This run can't say",
            "",
            f"the answer needs touches at {NEEDS[question]} (probing.strategies).",
            "comparison",
            rule=rule,
        )
    found = verdict(own)
    first = own[0]
    plus, minus = first.places
    finding = FINDINGS[found.word]
    if found.word == "not settled":
        finding = f"{finding} by {counted(first.objects, 'object')}"
    excluded = ""
    # An end of 100 points excludes nothing, and an end below 0 is said by the lead itself.
    if found.excluded is not None and 0 < found.excluded < 1 and not found.ahead:
        end = verdict(own, "classes").excluded
        more = "" if end is None or end >= 1 else f" (new classes: {percent_points(end)})"
        excluded = (
            f" A lead above {percent_points(found.excluded)} points is excluded"
            f"{' in each comparison' if len(own) > 1 else ''}{more}."
        )
    return Answer(
        QUESTIONS[question],
        finding,
        f"{points(first.difference.mean)} points",
        f"{both_intervals(first.difference, points)} is the lead of {plus} over {minus} in "
        f"{name_of_pipeline(first.pipeline)}{_over_draws(first)}.{excluded}".lstrip(),
        "comparison",
        rule=rule,
    )


def _over_draws(lead: Lead) -> str:
    """Return, in brackets, the number of draws of random places and the standard deviation of the lead over draws."""
    if lead.draws < 2:
        return f" (one draw of {lead.places[1]})"
    spread = percent_points(lead.deviation)
    return f" (mean of {lead.draws} draws of {lead.places[1]}; standard deviation over draws {spread} points)"


def strategies_answer(table: PipelineTable) -> Answer | None:
    """Return the answer to the question how strategies other than random places in reach and in sight compare.

    Figures are of the headline classifier of a pipeline. None if the run has no strategy except fixations.

    Returns
    -------
    Answer or None
        Fixations are ahead of a strategy or behind if the p value after Holm's correction, over all classifiers and strategies of
        the pipeline, is below `SIGNIFICANCE`. The number is the first strategy's lead.
    """
    compared = {
        name: comparison
        for name, comparison in table.headline.comparisons.items()
        if name not in PLACES
    }
    if not compared:
        return None
    shown = {
        strategy_name(name): comparison.difference.mean
        for name, comparison in compared.items()
        if comparison.adjusted_p < SIGNIFICANCE
    }
    ahead = [name for name, lead in shown.items() if lead < 0]
    behind = [name for name, lead in shown.items() if lead > 0]
    said = [f"behind {listed(ahead)}"] if ahead else []
    said += [f"ahead of {listed(behind)}"] if behind else []
    (name, first), *others = compared.items()
    more = "".join(
        f", over {strategy_name(name)} {with_interval(one.difference, points)}"
        for name, one in others
    )
    return Answer(
        "How do other strategies compare with fixations?",
        f"Fixations are {listed(said)}"
        if said
        else f"No difference is shown by {counted(first.objects, 'object')}",
        f"{points(first.difference.mean)} points",
        f"{both_intervals(first.difference, points)} is the lead of fixations over {strategy_name(name)}{more} "
        f"({table.headline.name}, {pipeline_name(table.name)}).".lstrip(),
        "comparison",
        rule=f"Rule: fixations are ahead or behind if p is below {SIGNIFICANCE:g} after Holm's correction for all "
        "classifiers and strategies of the pipeline.",
    )


def reproduction_answer(table: PipelineTable) -> Answer | None:
    """Return the answer to the question whether a pipeline reproduces the published accuracies.

    All classifiers and strategies with a published accuracy count; `verdict_on` has the rule. Published accuracies
    count as exact, because they have no intervals.

    Returns
    -------
    Answer or None
        Finding ``Reproduced`` if all published accuracies are reproduced, ``Differs`` if one differs or more, else
        ``Undecided``. None without a published accuracy.
    """
    compared = [
        (row.accuracy[strategy], published)
        for row in table.rows
        for strategy, published in row.published.items()
        if strategy in row.accuracy
    ]
    if not compared:
        return None
    verdicts = [verdict_on(here, published) for here, published in compared]
    same, differing = verdicts.count("reproduced"), verdicts.count("differs")
    finding = "Undecided"
    if same == len(verdicts):
        finding = "Reproduced"
    elif differing:
        finding = "Differs"
    margin = f"{100 * MARGIN:.0f} points"
    return Answer(
        "Is the paper reproduced?",
        finding,
        "",
        f"of {len(verdicts)} published accuracies {differing} differ (they lie outside our interval), {same} are "
        f"reproduced, and {len(verdicts) - same - differing} are undecided."
        f"{_too_wide([here for here, _ in compared], table.objects)} Our objects differ from the paper's objects.",
        "comparison",
        rule=f"Rule: a published accuracy is reproduced if our whole interval lies within {margin} of it (a test of "
        "equivalence). Otherwise it differs if it lies outside our interval, and is undecided if it lies inside. Each is "
        "judged by itself. Published accuracies have no intervals and count as exact.",
    )


def verdict_on(here: Estimate, published: float) -> Literal["reproduced", "differs", "undecided"]:
    """Return whether an accuracy with its interval reproduces a published accuracy.

    ``reproduced``: the whole interval lies within `MARGIN` of the published accuracy. ``differs``: not reproduced, and
    the interval excludes the published accuracy. ``undecided``: all other cases, also without an interval.
    """
    if here.low is None or here.high is None:
        return "undecided"
    if published - MARGIN <= here.low and here.high <= published + MARGIN:
        return "reproduced"
    return "undecided" if here.holds(published) else "differs"


def _too_wide(accuracies: Sequence[Estimate], objects: int) -> str:
    """Return a sentence if every interval is wider than the margin on both sides, so that none can be reproduced."""
    widths = [
        here.high - here.low
        for here in accuracies
        if here.low is not None and here.high is not None
    ]
    if not widths or min(widths) <= 2 * MARGIN:
        return ""
    return (
        f" With {counted(objects, 'object')} none can be shown to be reproduced: our intervals are "
        f"{percent_points(min(widths))} to {percent_points(max(widths))} points wide, wider than the margin of "
        f"{100 * MARGIN:.0f} points to either side."
    )


def has_opponent(table: PipelineTable) -> bool:
    """Return whether a pipeline's headline classifier has a comparison of fixations with `MAIN_OPPONENT`."""
    return table.leading == REFERENCE and MAIN_OPPONENT in table.headline.comparisons
