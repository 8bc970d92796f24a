"""The sections of the report on the cues of a touch: measured in this run, or else kept."""

from __future__ import annotations

from collections.abc import Iterator

from cues.kept import MeasuredCues, kept_cues_of, read_cues
from cues.sentences import carries_sentence, imprints_sentence
from cues.study import STUDY
from cues.tables import ACCURACIES
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.section import (
    OTHER_OBJECTS,
    ReportContext,
    SourceTable,
    sentences_section,
)


def own_sentences(context: ReportContext) -> Iterator[str]:
    """Yield sentences on the cues that were measured in this run."""
    path = context.run.existing_file(STUDY.kept)
    if path is not None:
        yield from _sentences(read_cues(path), context.run.parameters.recognition.intervals)


def kept_sentences(context: ReportContext) -> Iterator[str]:
    """Yield sentences on the kept cues, if the run has none of its own."""
    parameters = context.run.parameters
    if context.run.existing_file(STUDY.kept) is None:
        yield from _sentences(kept_cues_of(parameters.meshes.set), parameters.recognition.intervals)


def _sentences(measured: MeasuredCues, intervals: IntervalParameters) -> Iterator[str]:
    yield carries_sentence(measured, intervals)
    yield imprints_sentence(measured, intervals)


SECTIONS = (
    sentences_section(
        STUDY.name,
        STUDY.title,
        own_sentences,
        reads=(SourceTable("Accuracies by cue", ACCURACIES, STUDY.kept),),
    ),
    sentences_section("kept", "Touch, or where the sensor is?", kept_sentences, OTHER_OBJECTS),
)
