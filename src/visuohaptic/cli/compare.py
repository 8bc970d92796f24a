"""`visuohaptic compare`: one page of what differs between runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from visuohaptic.cli.printing import JsonOption, folder_to_write, say, say_json
from visuohaptic.optional_packages import require
from visuohaptic.whole_files import write_whole

PAGE = "comparison.html"


def compare(
    runs: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="A B...", help="Metrics files, reports, folders of runs, or DVC experiments."
        ),
    ] = None,
    experiments: Annotated[  # noqa: FBT002
        bool, typer.Option("--experiments", help="Add all experiments that DVC keeps.")
    ] = False,
    out: Annotated[Path, typer.Option(parser=folder_to_write, help="Folder for the page.")] = Path(
        "comparison"
    ),
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Write one page of what differs between runs: each is compared with the first.

    It shows parameters, code, packages, machine, seconds, and accuracies with intervals. All but
    the accuracies come from the report.html beside the metrics; without one, parameters come from a
    params.yaml beside them or a folder above.

    Example: visuohaptic compare before/reports/metrics.json reports/metrics.json --out comparison
    """
    require("report", "jinja2", "matplotlib", "plotly")
    from visuohaptic.report.measured_runs import list_experiments, read_measured_run
    from visuohaptic.report.run_comparison import compare_runs, render_comparison

    sources = [*(runs or ()), *(list_experiments() if experiments else ())]
    found = compare_runs([read_measured_run(source) for source in sources])
    page = out / PAGE
    write_whole(page, render_comparison(found))
    if as_json:
        say_json(vars(found) | {"page": page})
        return
    for sentence in found.verdicts:
        say(sentence)
    say(f"  {page}")
