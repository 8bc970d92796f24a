"""The experiment's two questions, each with the answer that follows from the tables by a rule."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from visuohaptic.report.comparison import REFERENCE, ClassifierRow, Figure, PipelineTable
from visuohaptic.report.wording import counted, listed, percent, points, spaced
from visuohaptic.studies.figures import Row
from visuohaptic.studies.readings.leads import sum_up
from visuohaptic.studies.readings.verdicts import (
    GAIN,
    SETS,
    Verdict,
    lead_evidence,
    of_papers_question,
    verdict,
)

BEST_OF_PAPER = "support_vector_machine"
"""The paper's most accurate classifier; the answers are its, where it was run."""

MAIN_OPPONENT = "random"
WORDS: Mapping[Verdict, str] = {
    "yes": "Yes",
    "no": "No",
    "depends": "It depends",
    "not shown": "That is not shown",
}


@dataclass(frozen=True)
class Answer:
    """A question, the verdict on it, and the figures that the verdict follows from, in a sentence."""

    question: str
    verdict: Verdict
    sentence: str

    @property
    def word(self) -> str:
        """The verdict as an answer, such as ``Yes``."""
        return WORDS[self.verdict]


def recognition_answer(
    tables: Sequence[PipelineTable], classes: int, touches: int, unseen: str
) -> Answer:
    """Answer whether objects can be recognised by touch.

    Yes, if the interval of every pipeline lies above chance; no, if each excludes `GAIN` above it.

    Parameters
    ----------
    tables : sequence of PipelineTable
        At least one, the paper's pipeline first.
    classes, touches : int
        How many classes there are, and how many touches a sequence has.
    unseen : str
        What training had not met of what is tested, such as ``an object that was not in training``.
    """
    found = [_row_of(table).accuracy[table.leading] for table in tables]
    chance = 1 / classes
    word: Verdict = "not shown"
    if all(figure.low is not None and figure.low > chance for figure in found):
        word = "yes"
    elif all(figure.high is not None and figure.high < chance + GAIN for figure in found):
        word = "no"
    shares = [
        f"{percent(figure.mean)}{_span(figure, percent)} in pipeline {spaced(table.name)}"
        for table, figure in zip(tables, found, strict=True)
    ]
    return Answer(
        "Can an object be recognised by touch?",
        word,
        f"With the {_row_of(tables[0]).name}, sequences of {counted(touches, 'touch')} on {unseen} "
        f"are classified correctly in {listed(shares)}; guessing among "
        f"{counted(classes, 'class')} gives {percent(chance)}.",
    )


def fixation_answer(
    tables: Sequence[PipelineTable], readings: Mapping[str, Sequence[Row]]
) -> Answer | None:
    """Answer whether it helps to touch where the eye would fixate, against random places in reach.

    Parameters
    ----------
    tables : sequence of PipelineTable
        Of the run, at least one.
    readings : mapping of str to sequence of Row
        Rows of `tables.READINGS` by set of objects, for the rule in `verdicts`.

    Returns
    -------
    Answer or None
        None for a run without random touches in reach.
    """
    compared = [
        (table, row.comparisons[MAIN_OPPONENT])
        for table in tables
        for row in [_row_of(table)]
        if table.leading == REFERENCE and MAIN_OPPONENT in row.comparisons
    ]
    if not compared:
        return None
    leads = [
        f"by {points(found.difference.mean)} points{_span(found.difference, points)} in pipeline "
        f"{spaced(table.name)}"
        for table, found in compared
    ]
    main = compared[0][1]
    sentence = (
        f"With the {_row_of(compared[0][0]).name} on {counted(main.objects, 'object')}, fixation is "
        f"ahead of random places that the sensor can reach {listed(leads)}."
    )
    spread = [_spread(readings[name]) for name in SETS if readings.get(name)]
    if any(spread):
        sentence += (
            " Over the readings of what the paper leaves open it is "
            f"{listed([one for one in spread if one])}."
        )
    return Answer(
        "Does it help to touch where the eye would fixate?",
        verdict(lead_evidence(readings, BEST_OF_PAPER)),
        sentence,
    )


def _row_of(table: PipelineTable) -> ClassifierRow:
    return next((row for row in table.rows if row.key == BEST_OF_PAPER), table.best)


def _span(figure: Figure, write: Callable[[float], str]) -> str:
    if figure.low is None or figure.high is None:
        return ""
    return f" ({write(figure.low)} to {write(figure.high)})"


def _spread(rows: Sequence[Row]) -> str:
    found = of_papers_question(rows, BEST_OF_PAPER, "reachable")
    if not found:
        return ""
    lead = sum_up(found)
    return (
        f"significantly ahead in {lead.ahead_significantly} of {lead.cases} and significantly "
        f"behind in {lead.behind_significantly} on {max(row['objects'] for row in found)} objects"
    )
