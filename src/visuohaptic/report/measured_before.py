"""Results that were measured before on named objects and are kept with the package: the folded part of the page.

No other part of the page has figures that the run did not measure.
"""

from __future__ import annotations

from collections.abc import Iterator

from visuohaptic.report.cues import carries_sentence, imprints_sentence
from visuohaptic.report.evaluation import odd_sentence
from visuohaptic.report.gaze import gaze_sentence
from visuohaptic.report.section import OTHER_OBJECTS, ReportContext, sentences_section
from visuohaptic.report.stability import describe_hard_cases, read_hard_cases
from visuohaptic.report.variants import papers_pipeline_sentences, variant_counts_sentence


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


def _hard_cases(context: ReportContext) -> Iterator[str]:
    path = context.run.extra_path("hard_cases")
    if path is not None:
        yield describe_hard_cases(read_hard_cases(path))


MEASURED_BEFORE = (
    sentences_section("cues", "Touch, or where the sensor is?", _cues, OTHER_OBJECTS),
    sentences_section("variants", "All variants of the paper", _variants, OTHER_OBJECTS),
    sentences_section("odd", "Untypical objects", lambda context: [odd_sentence(context.evaluation)], OTHER_OBJECTS),
    sentences_section("gaze", "Saliency and people's gaze", lambda context: [gaze_sentence(context.run.files.gaze)], OTHER_OBJECTS),
    sentences_section("hard-cases", "Hard cases of the code", _hard_cases, OTHER_OBJECTS),
)  # fmt: skip
"""The sections of chapter `OTHER_OBJECTS`."""
