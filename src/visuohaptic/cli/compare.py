"""`visuohaptic compare`: a table of the parameters and accuracies in which runs differ."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.base.csv_cells import csv_cell
from visuohaptic.base.optional_packages import require
from visuohaptic.cli.printing import JsonOption, say, say_json

RunsArgument = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="A B...", help="Metrics files, folders of runs, DVC experiments or Git revisions."
    ),
]


def compare(
    runs: RunsArgument = None,
    experiments: Annotated[  # noqa: FBT002
        bool, typer.Option("--experiments", help="Add all DVC experiments.")
    ] = False,
    csv: Annotated[Path | None, typer.Option("--csv", help="CSV file for the table.")] = None,
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Compare runs with the first run: changed parameters, accuracies, and paired differences over objects.

    Example: visuohaptic compare before.json reports/metrics.json --csv runs.csv
    """
    require("report", "pandas")
    from visuohaptic.report.compare_runs import (
        compare_runs,
        comparison_lines,
        list_experiments,
        read_metrics,
    )

    sources = [*(runs or ()), *(list_experiments() if experiments else ())]
    table = compare_runs([read_metrics(source) for source in sources])
    table["source"] = [sources[ord(run) - ord("A")] for run in table.run]
    if csv is not None:
        atomic_write_text(csv, table.map(csv_cell).to_csv(index=False))
    if as_json:
        say_json(table.astype(object).where(table.notna(), None).to_dict("records"))
        return
    for line in comparison_lines(table):
        say(line.rstrip())
