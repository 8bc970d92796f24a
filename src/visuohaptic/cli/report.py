"""`visuohaptic report`: write the report of a finished run, without the workflow."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from visuohaptic.base.optional_packages import require
from visuohaptic.cli.printing import JsonOption, folder_to_write, say, say_json

PAGE = "report.html"


def report(
    run: Annotated[
        Path, typer.Argument(metavar="RUN", help="Folder of a finished run.", show_default=".")
    ] = Path(),
    out: Annotated[Path, typer.Option(parser=folder_to_write, help="Folder for the page.")] = Path(
        "report"
    ),
    as_json: JsonOption = False,  # noqa: FBT002
) -> None:
    """Write the report of a finished run: one HTML page that needs no network.

    The workflow writes the same page to reports/report.html. This command neither runs phases nor changes the run.

    Example: visuohaptic report . --out report
    """
    require("report", "jinja2", "matplotlib")
    from visuohaptic.report.page import make_report
    from visuohaptic.report.run import find_run

    files, parameters, objects = find_run(run)
    page = out / PAGE
    make_report(files, page, parameters, objects)
    if as_json:
        say_json({"page": page, "bytes": page.stat().st_size, "objects": objects})
        return
    say(f"{page}: {len(objects)} objects, {page.stat().st_size / 1e6:.1f} MB")
