"""`visuohaptic compare`: one page of what changed from one run to another."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from visuohaptic.cli.printing import folder_to_write, say, say_json
from visuohaptic.optional_packages import require
from visuohaptic.whole_files import write_whole

PAGE = "comparison.html"


def compare(
    first: Annotated[
        Path,
        typer.Argument(
            metavar="A", help="A metrics.json, a report, a run's folder, or a DVC experiment."
        ),
    ],
    second: Annotated[Path, typer.Argument(metavar="B", help="The run to compare it with.")],
    out: Annotated[Path, typer.Option(parser=folder_to_write, help="Folder for the page.")] = Path(
        "comparison"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for machines.")] = False,  # noqa: FBT002
) -> None:
    """Write one page of what changed from run A to run B.

    It shows parameters, accuracies with intervals, seconds, and views side by side. All but the
    accuracies come from the report.html beside the metrics; without one, parameters come from a
    params.yaml beside them or a folder above.

    Example: visuohaptic compare before/reports/metrics.json reports/metrics.json --out comparison
    """
    require("report", "jinja2", "matplotlib", "plotly")
    from visuohaptic.report.run_comparison import compare_runs, read_measured_run, render_comparison

    found = compare_runs(read_measured_run(first), read_measured_run(second))
    out.mkdir(parents=True, exist_ok=True)
    page = out / PAGE
    write_whole(page, render_comparison(found))
    if as_json:
        say_json(found.as_values() | {"page": page})
        return
    say(found.verdict)
    say(f"  {page}")
