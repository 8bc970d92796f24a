"""The sections of the report on all variants: measured in this run, or else kept."""

from __future__ import annotations

from collections.abc import Iterator

from variants.result import (
    SUMMARY,
    papers_pipeline_sentences,
    read_summary,
    variant_counts_sentence,
)
from variants.study import STUDY
from variants.summary import kept_summary
from visuohaptic.report.section import (
    OTHER_OBJECTS,
    ReportContext,
    Section,
    Values,
    sentences_section,
)


def variants_values(context: ReportContext) -> Values | None:
    """Return the summary of the variants of this run; None if the run has none."""
    path = context.run.existing_file(SUMMARY)
    return {"variants": read_summary(path)} if path else None


def kept_sentences(context: ReportContext) -> Iterator[str]:
    """Yield sentences on the kept variants, if the run has none of its own."""
    kept = kept_summary()
    if kept.source is not None and context.run.existing_file(SUMMARY) is None:
        yield variant_counts_sentence(kept)
        yield papers_pipeline_sentences(kept)
        yield f"Measured on {kept.source.date}."


SECTIONS = (
    Section(STUDY.name, STUDY.title, variants_values),
    sentences_section("kept", "All variants of the paper", kept_sentences, OTHER_OBJECTS),
)
