"""The experiment's two questions, each with the answer that follows from the tables by a rule."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from visuohaptic.report.comparison import (
    PAPER_PIPELINE,
    REFERENCE,
    Comparison,
    PipelineTable,
)
from visuohaptic.report.estimates import with_interval
from visuohaptic.report.variants import VariantsSummary, Verdict
from visuohaptic.report.wording import counted, percent, points

GAIN = 0.02
"""A gain, as a share, that is worth having."""

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

    `number` is the figure that the verdict rests on, `sentence` says in at most 25 words what it is of, `link` is the
    anchor of the section that shows more, and `recount` are lines of Python that print the number.
    """

    question: str
    verdict: Verdict
    number: str
    sentence: str
    link: str
    recount: str = ""

    @property
    def word(self) -> str:
        """The verdict as an answer, such as ``Yes``."""
        return self.verdict.capitalize()


def recognition_answer(
    tables: Sequence[PipelineTable], classes: int, touches: int, unseen: str
) -> Answer:
    """Answer whether objects can be recognised by touch; `unseen` is what training had not met.

    Yes, if the interval of every pipeline lies above chance; no, if each excludes `GAIN` above it.
    """
    found = [table.headline.accuracy[table.leading] for table in tables]
    chance = 1 / classes
    word: Verdict = "not shown"
    if all(figure.low is not None and figure.low > chance for figure in found):
        word = "yes"
    elif all(figure.high is not None and figure.high < chance + GAIN for figure in found):
        word = "no"
    others = [
        f"{pipeline_name(table.name)} {percent(figure.mean)}"
        for table, figure in zip(tables[1:], found[1:], strict=True)
    ]
    return Answer(
        "Can an object be recognised by touch?",
        word,
        with_interval(found[0], percent),
        f"of {touches}-touch sequences of {unseen} correctly classified by {pipeline_name(tables[0].name)} "
        f"({tables[0].headline.name}); {', '.join([*others, f'guessing {percent(chance, 0)}'])}.",
        "comparison",
    )


def fixation_answer(tables: Sequence[PipelineTable], variants: VariantsSummary) -> Answer | None:
    """Answer whether it helps to touch where the eye would fixate; None without random touches in reach."""
    compared = [
        (table, table.headline.comparisons[MAIN_OPPONENT])
        for table in tables
        if has_opponent(table)
    ]
    if not compared:
        return None
    (first, main), *others = compared
    further = [
        f"; {pipeline_name(table.name)} {with_interval(found.difference, points)}"
        for table, found in others
    ]
    return Answer(
        "Does it help to touch where the eye would fixate?",
        variants.verdict,
        with_interval(main.difference, points, " points"),
        f"correctly classified above random touches{_over_draws(main)}, {pipeline_name(first.name)}, "
        f"{counted(main.objects, 'object')}{''.join(further)}; {REASONS[variants.verdict]}.",
        "comparison",
    )


def _over_draws(compared: Comparison) -> str:
    """Say how many draws of random places a lead is the mean of; empty with a single draw."""
    return f" (mean of {compared.draws.count} draws)" if compared.draws else ""


def reproduction_answer(table: PipelineTable) -> Answer | None:
    """Answer whether the published accuracies are found again; None where none is comparable.

    Yes, if every published accuracy lies within the interval found here; no, if none does.
    """
    pairs = [
        (row.accuracy[strategy], published)
        for row in table.rows
        for strategy, published in row.published.items()
        if strategy in row.accuracy
    ]
    if not pairs:
        return None
    inside = sum(figure.holds(published) for figure, published in pairs)
    word: Verdict = "yes" if inside == len(pairs) else "depends" if inside else "no"
    row = table.headline
    number = against = ""
    if table.leading in row.published:
        here, published = row.accuracy[table.leading], row.published[table.leading]
        number = with_interval(here, percent)
        against = f"here, {percent(published, 2)} published ({row.name}); "
    return Answer(
        "Is the paper reproduced?",
        word,
        number,
        f"{against}{inside} of {len(pairs)} published accuracies lie within the intervals found here "
        "(for other objects).",
        "comparison",
    )


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


def has_opponent(table: PipelineTable) -> bool:
    """Return whether the answers' classifier was tried by fixation and by random touches in reach."""
    return table.leading == REFERENCE and MAIN_OPPONENT in table.headline.comparisons


def pipeline_name(name: str) -> str:
    """Name a pipeline in a sentence."""
    return "the paper's pipeline" if name == PAPER_PIPELINE else f"pipeline {name}"
