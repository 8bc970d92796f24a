"""Python code for readers, which computes a number of the page again from the run's own tables.

The code is in the templates ``recount_….py.jinja``.
"""

from __future__ import annotations

from jinja2 import Environment, PackageLoader, StrictUndefined

from visuohaptic.report.comparison import PipelineTable
from visuohaptic.report.cost import robot_price
from visuohaptic.report.estimates import Row
from visuohaptic.report.questions import MAIN_OPPONENT
from visuohaptic.report.run import Run
from visuohaptic.report.sources import files_of_rows, place_of

_CODE = Environment(  # noqa: S701 - the page escapes the code
    loader=PackageLoader("visuohaptic.report"),
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
)
_CODE.filters["literal"] = repr


def recount_accuracy(run: Run, table: PipelineTable) -> str:
    """Return code that prints the headline classifier's accuracy by the leading strategy."""
    return _CODE.get_template("recount_accuracy.py.jinja").render(_selection(run, table))


def recount_lead(run: Run, table: PipelineTable, opponent: str = MAIN_OPPONENT) -> str:
    """Return code that prints the lead of fixation over another strategy, the mean over all its draws."""
    drawn = run.parts("drawn")
    return _CODE.get_template("recount_lead.py.jinja").render(
        **_selection(run, table),
        drawn=place_of(run, drawn).as_posix() if drawn else "",
        other=opponent,
    )


def recount_cost(run: Run, row: Row) -> str:
    """Return code that prints a robot's seconds and the error rate of a setting of this run."""
    return _CODE.get_template("recount_cost.py.jinja").render(
        path=place_of(run, run.parts("frontier")).as_posix(),
        family=row["family"],
        setting=row["setting"],
        price=robot_price(row, run.parameters.cost),
    )


def _selection(run: Run, table: PipelineTable) -> dict[str, str]:
    """Return the file, pipeline and classifier of a table's headline, and the strategy that leads."""
    files = files_of_rows(run.parts("predictions"), {"pipeline": table.name})
    return {
        "path": place_of(run, files).as_posix(),
        "pipeline": table.name,
        "classifier": table.headline.key,
        "strategy": table.leading,
    }
