"""The section of the report on all variants of this run."""

from __future__ import annotations

from variants.study import STUDY
from visuohaptic.report.section import ReportContext, Section, Values


def variants_values(context: ReportContext) -> Values | None:
    """Return the summary of the variants of this run; None if the run has none."""
    if context.variants.source is not None:
        return None
    return {"variants": context.variants}


SECTION = Section(STUDY.name, STUDY.title, variants_values)
