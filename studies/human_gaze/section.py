"""The section of the report on saliency and people's gaze."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from human_gaze.saliency_sentence import gaze_sentence
from human_gaze.tables import AGREEMENT
from visuohaptic.report.section import OTHER_OBJECTS, ReportContext, sentences_section
from visuohaptic.studies.keeping import kept_file, read_source
from visuohaptic.tables.schema import read_table

KEPT = kept_file(Path(__file__).parent, "gaze")


def sentences(_context: ReportContext) -> Iterator[str]:
    """Yield the sentence on the kept agreement."""
    yield gaze_sentence(read_table(AGREEMENT, KEPT), read_source(KEPT).date)


SECTION = sentences_section("human_gaze", "Saliency and people's gaze", sentences, OTHER_OBJECTS)
