"""Fill docs/two_questions.md and draw its pictures from the kept leads: `make readme` and `make draws`."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from filling import (
    DOCS,
    fill_page,
    legend_beside,
    plain,
    resized,
    save_picture,
    table,
    wrapped,
)
from matplotlib.figure import Figure

from learned.compared import count_classes, kept_of_all, leads_of, objects_in_words
from turned.leads import KeptLead, KeptLeads, lead_in_words, question_sentence, read_kept_leads
from visuohaptic.evaluation.leads import LEADS, LEADS_OF, Question
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report import figures
from visuohaptic.report.drawing import style
from visuohaptic.report.estimates import with_interval
from visuohaptic.report.leads import KNOWN, PLACES, Lead, Verdict, verdict
from visuohaptic.report.questions import QUESTIONS
from visuohaptic.report.wording import percent_points, points, titled

PICTURES = DOCS / "pictures"
OF_README = ("sight", "salience")
"""Leads in the picture of README: they add up to the lead of fixations over random places in reach."""
COLUMNS = ("sight", "seeing", "salience")
"""Leads in the order of the table."""


def blocks(kept: KeptLeads) -> dict[str, str]:
    """Return the sentences and the table of the page by name of the block."""
    return {
        "sentences": sentences(kept),
        "more classes": wrapped(plain(more_classes(*kept_of_all()))),
        "leads": leads_table(kept),
    }


def sentences(kept: KeptLeads) -> str:
    """Return each question with its answer, a paragraph each."""
    return "\n\n".join(
        wrapped(f"**{words}** {plain(question_sentence(question, kept))}")
        for question, words in QUESTIONS.items()
    )


def more_classes(rows: pd.DataFrame, others: pd.DataFrame) -> str:
    """Return the leads that are shown on set ``all``, in kept rows of all objects and of those outside the benchmark."""
    shared = rows["object"].nunique() - others["object"].nunique()
    leads, other_leads = leads_of(rows), leads_of(others)
    return (
        f"**And on more classes?** Leads were measured on {objects_in_words(leads)} objects of {count_classes(rows)} classes of set `all`, "
        f"too: upright, facing one way, five touches, one draw of places, by pipelines `order_free` and `learned`, with all, "
        f"centre and vertical, centre, or nothing of the pose known. {seeing_sentence(leads)} {salience_sentence(leads)} "
        f"{shared} of the objects are in the benchmark. On the {objects_in_words(other_leads)} others: "
        f"{seeing_sentence(other_leads)} {salience_sentence(other_leads)} A lead is shown if it stands after Holm's correction "
        f"for all comparisons of the question on the same objects. No question was written before these figures were computed "
        f"([learned](../studies/learned/README.md))."
    )


def verdicts(question: Question, leads: Sequence[Lead]) -> tuple[Verdict, Verdict]:
    """Answer a question by its leads, for new objects and for new classes."""
    own = [one for one in leads if one.name in LEADS_OF[question]]
    return verdict(own), verdict(own, "classes")


def seeing_sentence(leads: Sequence[Lead]) -> str:
    """Return the shown leads of places in sight over random places in reach."""
    found, drawn = verdicts("seeing", leads)
    shown = "; ".join(
        f"{one.places[0]}, `{one.pipeline}`, {KNOWN[one.known]} known: {lead_in_words(one)}"
        for one in found.ahead
    )
    return (
        f"Places in sight are shown to lead random places in reach in {len(found.ahead)} of {len(found.leads)} comparisons and to trail "
        f"in {len(found.behind)}; for new classes they lead in {len(drawn.ahead)} and trail in {len(drawn.behind)}."
        f"{f' Shown are: {shown}.' if shown else ''}"
    )


def salience_sentence(leads: Sequence[Lead]) -> str:
    """Return the shown leads of fixations over random places in sight, their range, and the leads that are excluded."""
    found, drawn = verdicts("salience", leads)
    if found.excluded is None or drawn.excluded is None:
        raise ValueError("a lead on set all has no interval: write the sentence on salience again.")
    means = [one.difference.mean for one in found.leads]
    return (
        f"Fixations are shown to lead random places in sight in {len(found.ahead)} of {len(found.leads)} comparisons and to trail in "
        f"{len(found.behind)}; the leads are {points(min(means))} to {points(max(means))} points, and leads above "
        f"{percent_points(found.excluded)} points are excluded (for new classes above {percent_points(drawn.excluded)})."
    )


def leads_table(kept: KeptLeads) -> str:
    """Return a table with one row per condition; leads that are shown after correction for their question are bold."""
    answers = [verdict(kept.of(question)) for question in QUESTIONS]
    shown = {(lead.condition, lead.name) for one in answers for lead in (*one.ahead, *one.behind)}
    rows: dict[str, dict[str, str]] = {}
    for lead in kept.leads:
        words = plain(with_interval(lead.difference, points))
        bold = f"**{words}**" if (lead.condition, lead.name) in shown else words
        rows.setdefault(lead.condition, {"draws": str(lead.draws)})[lead.name] = bold
    heads = ["condition", "draws"]
    heads += [" minus ".join(PLACES[strategy] for strategy in LEADS[name]) for name in COLUMNS]
    return table(
        heads,
        [
            [titled(name), *(row.get(one, "") for one in ("draws", *COLUMNS))]
            for name, row in rows.items()
        ],
    )


@style()
def leads_by_class(shown: Sequence[KeptLead]) -> Figure:
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


if __name__ == "__main__":
    kept = read_kept_leads(IntervalParameters())
    fill_page(DOCS / "two_questions.md", blocks(kept))
    main = [
        lead
        for lead in kept.leads
        if lead.known == "full"
        and lead.pipeline != "literal"
        and lead.turns != "vertical"
        and lead.name in OF_README
    ]
    save_picture(legend_beside(resized(figures.leads(main), 200, 820)), PICTURES / "leads.png")
    save_picture(figures.leads(kept.leads), PICTURES / "leads_by_frame.png", 150)
    for leads in kept.by_class():
        save_picture(
            leads_by_class(leads), PICTURES / f"leads_by_class_{leads[0].pipeline}.png", 150
        )
