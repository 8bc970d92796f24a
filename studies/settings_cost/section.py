"""The section of the report on accuracy and run time of every setting."""

from __future__ import annotations

from settings_cost.study import STUDY, families_of
from visuohaptic.report.cost import cost_figures
from visuohaptic.report.section import ReportContext, Section, SourceTable, Values
from visuohaptic.studies.cost.cost_rows import read_costs
from visuohaptic.tables.studies import COST

COSTS = "results/settings_cost.parquet"


def settings_cost_values(context: ReportContext) -> Values | None:
    """Return the values of the section; None if the run has no table of the study."""
    path, run = context.run.existing_file(COSTS), context.run
    rows = read_costs(path, tuple(families_of(run.parameters))) if path else []
    if not rows:
        return None
    return {"costs": cost_figures(rows, run.parameters), "objects": len(run.objects)}


SECTION = Section(
    STUDY.name, STUDY.title, settings_cost_values, (SourceTable("All settings", COST, COSTS),)
)
