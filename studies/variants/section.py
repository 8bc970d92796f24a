"""The section of the report on all variants, of this run or as kept with the package."""

from __future__ import annotations

from variants.study import STUDY
from visuohaptic.report.section import ReportContext, Section, Values


def variants_values(context: ReportContext) -> Values:
    """Return the summary of the variants for the template."""
    return {"variants": context.variants}


SECTION = Section(STUDY.name, STUDY.title, variants_values)
