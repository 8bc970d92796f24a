"""Results that were measured before on named objects and are kept with the package: the folded part of the page.

No other part of the page has figures that the run did not measure.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from visuohaptic.report.cues import carries_sentence, imprints_sentence
from visuohaptic.report.draws import kept_sentence, read_draws
from visuohaptic.report.estimates import Row
from visuohaptic.report.evaluation import odd_sentence
from visuohaptic.report.gaze import gaze_sentence
from visuohaptic.report.leads import KeptLeads, question_sentence, read_kept_leads
from visuohaptic.report.questions import QUESTIONS
from visuohaptic.report.run import Run
from visuohaptic.report.section import ReportContext, Values
from visuohaptic.report.stability import describe_hard_cases, read_hard_cases
from visuohaptic.report.turned import POSES, read_turned, turned_rows
from visuohaptic.report.variants import papers_pipeline_sentences, variant_counts_sentence
from visuohaptic.report.wording import titled


@dataclass(frozen=True)
class Earlier:
    """Sentences on one subject; each names the objects and the date of its figures."""

    subject: str
    sentences: tuple[str, ...]


def measured_before_values(context: ReportContext) -> Values:
    """Return the subjects, the kept leads of more objects, and the kept accuracies of turned objects."""
    leads = read_kept_leads(context.run.parameters.recognition.intervals)
    subjects = [
        Earlier(subject, sentences)
        for subject, found in _subjects(context, leads)
        if (sentences := tuple(filter(None, found)))
    ]
    return {"subjects": subjects, "leads": leads, "turned": kept_turned(context.run)}


def _subjects(
    context: ReportContext, leads: KeptLeads | None
) -> Iterator[tuple[str, tuple[str, ...]]]:
    run = context.run
    intervals, objects = run.parameters.recognition.intervals, run.parameters.meshes.set
    if leads is not None:
        for question, words in QUESTIONS.items():
            yield words, (question_sentence(question, leads),)
    if run.extra_path("cues") is None:
        yield (
            "Touch, or where the sensor is?",
            (carries_sentence(objects, intervals), imprints_sentence(objects, intervals)),
        )
    if context.variants.source is not None:
        yield (
            "All variants of the paper",
            (
                variant_counts_sentence(context.variants),
                papers_pipeline_sentences(context.variants),
                f"Measured on {context.variants.source.date}.",
            ),
        )
    draws = (read_draws(objects, table.name) for table in run.pipelines)
    yield "Further draws of random places", tuple(kept_sentence(kept) for kept in draws if kept)
    yield "Untypical objects", (odd_sentence(context.evaluation),)
    yield "Saliency and people's gaze", (gaze_sentence(run.files.gaze),)
    hard_cases = run.extra_path("hard_cases")
    if hard_cases is not None:
        yield "Hard cases of the code", (describe_hard_cases(read_hard_cases(hard_cases)),)


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
