"""Fill docs/two_questions.md and draw its pictures from the kept leads: `make readme` and `make draws`."""

from __future__ import annotations

from collections.abc import Sequence

from filling import (
    DOCS,
    fill_page,
    legend_beside,
    plain,
    read_json,
    resized,
    save_picture,
    table,
    wrapped,
)
from matplotlib.figure import Figure

from learned.all_classes import MEASURED, leads_of
from turned.leads import KeptLead, KeptLeads, question_sentence, read_kept_leads
from visuohaptic.evaluation.leads import LEADS, LEADS_OF, Question
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report import figures
from visuohaptic.report.drawing import style
from visuohaptic.report.estimates import Row, with_interval
from visuohaptic.report.leads import PLACES, Lead, verdict
from visuohaptic.report.questions import QUESTIONS
from visuohaptic.report.wording import points, titled

PICTURES = DOCS / "pictures"
OF_README = ("sight", "salience")
"""Leads in the picture of README: they add up to the lead of fixations over random places in reach."""
COLUMNS = ("sight", "seeing", "salience")
"""Leads in the order of the table."""


def blocks(kept: KeptLeads) -> dict[str, str]:
    """Return the sentences and the table of the page by name of the block."""
    return {
        "sentences": sentences(kept),
        "more classes": wrapped(more_classes_sentence(read_json(MEASURED)["leads"])),
        "leads": leads_table(kept),
    }


def sentences(kept: KeptLeads) -> str:
    """Return each question with its answer, a paragraph each."""
    return "\n\n".join(
        wrapped(f"**{words}** {plain(question_sentence(question, kept))}")
        for question, words in QUESTIONS.items()
    )


def more_classes_sentence(rows: Sequence[Row]) -> str:
    """Return how many leads are shown on set ``all``, and their range; `rows` are of `learned.all_classes`."""
    leads = leads_of(rows)
    return (
        f"**And on more classes?** On {max(lead.objects for lead in leads)} objects of {rows[0]['classes']} classes (set "
        f"`all`, upright, facing one way, five touches) pipelines `order_free` and `learned` know four parts of the pose. "
        f"Places in sight lead random places in reach {shown_leads('seeing', leads)}. Fixations lead random places in sight "
        f"{shown_leads('salience', leads)}. Holm's correction is for each question; there is one draw of places, and no "
        f"question was written before ([learned](../studies/learned/README.md))."
    )


def shown_leads(question: Question, leads: Sequence[Lead]) -> str:
    """Return in how many comparisons of a question a lead is shown, and the range of the leads."""
    own = [lead for lead in leads if lead.name in LEADS_OF[question]]
    found, drawn = verdict(own), verdict(own, "classes")
    means = [lead.difference.mean for lead in own]
    return (
        f"in {len(found.ahead)} of {len(own)} comparisons and trail in {len(found.behind)} (for new classes in "
        f"{len(drawn.ahead)} and {len(drawn.behind)}), by {points(min(means))} to {points(max(means))} points"
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
