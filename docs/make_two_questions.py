"""Fill docs/two_questions.md and draw its pictures from the kept leads: `make readme` and `make draws`."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import get_args

from filling import DOCS, fill_page, table
from matplotlib.figure import Figure as Chart

from turned.leads import KeptLead, KeptLeads, question_sentence, read_kept_leads
from visuohaptic.evaluation.intervals import holm
from visuohaptic.evaluation.leads import LEADS, Question
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report import figures
from visuohaptic.report.drawing import style
from visuohaptic.report.estimates import Figure, with_interval
from visuohaptic.report.leads import Lead
from visuohaptic.report.questions import QUESTIONS
from visuohaptic.report.wording import points, probability, titled

PICTURES = DOCS / "pictures"
OF_README = ("sight", "salience")
"""Leads in the picture of README: they add up to the lead of fixations over random places in reach."""


def blocks(kept: KeptLeads) -> dict[str, str]:
    """Return the sentences and the tables of the page by name of the block."""
    found = {"sentences": sentences(kept)}
    for question in get_args(Question):
        found[question] = leads_table(kept.of(question))
    return found


def sentences(kept: KeptLeads) -> str:
    """Return each question with its answer, a paragraph each."""
    return "\n\n".join(
        wrapped(f"**{words}** {plain(question_sentence(question, kept))}")
        for question, words in QUESTIONS.items()
    )


def leads_table(leads: tuple[Lead, ...]) -> str:
    """Return a table with one row per lead; p values are corrected by Holm for the rows of the table."""
    adjusted = holm([lead.p_value for lead in leads])
    of_classes = holm([lead.p_value_new_classes for lead in leads])
    heads = ["condition", "ahead of what", "draws", "lead, new objects", "p, corrected"]
    heads += ["new classes", "p, corrected"]
    rows = [
        [
            titled(lead.condition),
            " minus ".join(lead.places),
            lead.draws,
            plain(with_interval(lead.difference, points)),
            probability(p),
            ends(figures.of_new_classes(lead.difference)),
            probability(p_of_classes),
        ]
        for lead, p, p_of_classes in zip(leads, adjusted, of_classes, strict=True)
    ]
    return table(heads, rows)


def ends(figure: Figure) -> str:
    """Return the ends of an interval in percentage points; empty without an interval."""
    if figure.low is None or figure.high is None:
        return ""
    return f"{points(figure.low)} to {points(figure.high)}"


@style()
def leads_by_class(shown: Sequence[KeptLead]) -> Chart:
    """Draw the mean lead of each class's objects with its interval, one row per class, largest first lead on top.

    `shown` are leads of one condition with different compared strategies, at least one.
    """
    first = shown[0].by_class
    rows = sorted(first, key=lambda name: -first[name].mean)
    series = [
        figures.Series(
            figures.LEGENDS[lead.name],
            list(LEADS).index(lead.name),
            [lead.by_class.get(row) for row in rows],
        )
        for lead in shown
    ]
    return figures.draw_leads(rows, "class", series)


def plain(text: str) -> str:
    """Return a text with plain spaces."""
    return text.replace("\N{NO-BREAK SPACE}", " ")


def wrapped(text: str) -> str:
    """Return a paragraph of lines of at most 100 characters."""
    return textwrap.fill(text, 100, break_on_hyphens=False)


if __name__ == "__main__":
    kept = read_kept_leads(IntervalParameters())
    fill_page(DOCS / "two_questions.md", blocks(kept))
    fill_page(DOCS.parent / "paper" / "paper.md", {"sentences": sentences(kept)})
    main = [
        lead
        for lead in kept.leads
        if lead.known == "full" and lead.pipeline != "literal" and lead.name in OF_README
    ]
    for name, leads in (("leads", main), ("leads_by_frame", kept.leads)):
        figures.leads(leads).savefig(PICTURES / f"{name}.png", dpi=150, facecolor="white")
    for leads in kept.by_class():
        picture = PICTURES / f"leads_by_class_{leads[0].pipeline}.png"
        leads_by_class(leads).savefig(picture, dpi=150, facecolor="white")
