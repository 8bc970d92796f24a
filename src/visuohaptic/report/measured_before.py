"""Results that were measured before on named objects and are kept with the package: the folded part of the page.

No other part of the page has figures that the run did not measure.
"""

from __future__ import annotations

from collections.abc import Iterator

from visuohaptic.evaluation.leads import Question
from visuohaptic.report.cues import carries_sentence, imprints_sentence
from visuohaptic.report.draws import kept_sentence, read_draws
from visuohaptic.report.estimates import Row
from visuohaptic.report.evaluation import odd_sentence
from visuohaptic.report.gaze import gaze_sentence
from visuohaptic.report.leads import question_sentence, read_kept_leads
from visuohaptic.report.questions import QUESTIONS
from visuohaptic.report.run import Run
from visuohaptic.report.section import ReportContext, Section, Values, sentences_section
from visuohaptic.report.stability import describe_hard_cases, read_hard_cases
from visuohaptic.report.turned import POSES, read_turned, turned_rows
from visuohaptic.report.variants import papers_pipeline_sentences, variant_counts_sentence
from visuohaptic.report.wording import counted, titled

OTHER_OBJECTS = "Other objects"
"""The chapter of results that were measured before on named objects; the page folds its sections."""


def _answer(question: Question, context: ReportContext) -> Iterator[str]:
    leads = read_kept_leads(context.run.parameters.recognition.intervals)
    if leads is not None:
        yield question_sentence(question, leads)


def _cues(context: ReportContext) -> Iterator[str]:
    run = context.run
    if run.extra_path("cues") is None:
        for sentence in (carries_sentence, imprints_sentence):
            yield sentence(run.parameters.meshes.set, run.parameters.recognition.intervals)


def _variants(context: ReportContext) -> Iterator[str]:
    if context.variants.source is not None:
        yield variant_counts_sentence(context.variants)
        yield papers_pipeline_sentences(context.variants)
        yield f"Measured on {context.variants.source.date}."


def _draws(context: ReportContext) -> Iterator[str]:
    for table in context.run.pipelines:
        kept = read_draws(context.run.parameters.meshes.set, table.name)
        if kept is not None:
            yield kept_sentence(kept)


def _hard_cases(context: ReportContext) -> Iterator[str]:
    path = context.run.extra_path("hard_cases")
    if path is not None:
        yield describe_hard_cases(read_hard_cases(path))


def kept_leads_values(context: ReportContext) -> Values | None:
    """Return the kept leads of more objects, and the kept accuracies of turned objects; None without kept leads."""
    leads = read_kept_leads(context.run.parameters.recognition.intervals)
    if leads is None:
        return None
    return {
        "title": f"All leads on {counted(leads.objects, 'object')}",
        "leads": leads,
        "turned": kept_turned(context.run),
    }


def kept_turned(run: Run) -> Row | None:
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
        "date": kept.date,
        "objects": max(row.objects for row in rows),
        "draws": max(row.draws for row in rows),
    }


MEASURED_BEFORE = (
    sentences_section("seeing", QUESTIONS["seeing"], lambda context: _answer("seeing", context), OTHER_OBJECTS),
    sentences_section("salience", QUESTIONS["salience"], lambda context: _answer("salience", context), OTHER_OBJECTS),
    sentences_section("cues", "Touch, or where the sensor is?", _cues, OTHER_OBJECTS),
    sentences_section("variants", "All variants of the paper", _variants, OTHER_OBJECTS),
    sentences_section("draws", "Further draws of random places", _draws, OTHER_OBJECTS),
    sentences_section("odd", "Untypical objects", lambda context: [odd_sentence(context.evaluation)], OTHER_OBJECTS),
    sentences_section("gaze", "Saliency and people's gaze", lambda context: [gaze_sentence(context.run.files.gaze)], OTHER_OBJECTS),
    sentences_section("hard-cases", "Hard cases of the code", _hard_cases, OTHER_OBJECTS),
    Section("leads", "All leads on more objects", kept_leads_values, chapter=OTHER_OBJECTS),
)  # fmt: skip
"""The sections of chapter `OTHER_OBJECTS`."""
