"""The sections of the report on kept leads: the two questions on more objects, all leads, and turned objects."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

from turned.kept import read_turned
from turned.leads import question_sentence, read_kept_leads
from turned.rows import turned_rows
from turned.study import STUDY
from visuohaptic.evaluation.leads import Question
from visuohaptic.report.estimates import Row
from visuohaptic.report.questions import QUESTIONS
from visuohaptic.report.run import Run
from visuohaptic.report.section import (
    OTHER_OBJECTS,
    ReportContext,
    Section,
    Values,
    sentences_section,
)
from visuohaptic.report.wording import POSES, counted, titled

# Three sections show the leads, and their intervals take time.
_read_kept_leads = cache(read_kept_leads)


def leads_values(context: ReportContext) -> Values | None:
    """Return the kept leads of more objects, and the kept accuracies of turned objects; None without kept leads."""
    leads = _read_kept_leads(context.run.parameters.recognition.intervals)
    if leads is None:
        return None
    return {
        "title": f"All leads on {counted(leads.objects, 'object')}",
        "leads": leads,
        "turned": turned_values(context.run),
    }


def turned_values(run: Run) -> Row | None:
    """Return the kept accuracies of turned objects, of the run's set or else of the largest set; None without any."""
    by_set = read_turned()
    if not by_set:
        return None
    largest = max(by_set.values(), key=lambda kept: len(kept.objects))
    kept = by_set.get(run.parameters.meshes.set, largest)
    rows = turned_rows(kept, run.parameters.recognition.intervals)
    poses = {
        pose: {row.pipeline: row for row in rows if row.turns == turns}
        for turns, pose in POSES.items()
    }
    return {
        "rows": [{"pose": titled(pose), "by": by} for pose, by in poses.items() if by],
        "pipelines": list(dict.fromkeys(row.pipeline for row in rows)),
        "date": kept.source.date,
        "objects": max(row.objects for row in rows),
        "draws": max(row.draws for row in rows),
    }


def _answer(question: Question) -> Section:
    """Return the section that answers a question by kept leads."""

    def sentences(context: ReportContext) -> Iterator[str]:
        leads = _read_kept_leads(context.run.parameters.recognition.intervals)
        if leads is not None:
            yield question_sentence(question, leads)

    return sentences_section(question, QUESTIONS[question], sentences, OTHER_OBJECTS)


SECTIONS = (
    *map(_answer, QUESTIONS),
    Section(STUDY.name, STUDY.title, leads_values, chapter=OTHER_OBJECTS),
)
