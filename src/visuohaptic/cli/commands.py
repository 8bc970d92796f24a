"""The sub-commands of `visuohaptic`."""

from __future__ import annotations

from typing import Annotated

import typer

from visuohaptic import __version__
from visuohaptic.cli import (
    DEBUG,
    compare,
    evaluate,
    explore,
    export,
    meshes,
    new,
    press,
    report,
    tables,
)
from visuohaptic.cli.printing import say

app = typer.Typer(
    help="Look at a 3D object, touch the places where the eye would fixate, and recognise the object only from touch.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
for command in (
    *(explore.touch, explore.recognise, press.press, new.new, evaluate.evaluate),
    *(report.report, compare.compare, export.export, tables.tables),
):
    app.command()(command)
app.add_typer(meshes.app, name="meshes")


DebugOption = Annotated[bool, typer.Option(DEBUG, help="Print the traceback of an error.")]


def _show_version(is_given: bool) -> None:  # noqa: FBT001 - typer calls the function so
    if is_given:
        say(f"visuohaptic {__version__}")
        raise typer.Exit


VersionOption = Annotated[
    bool, typer.Option("--version", help="Show the version.", callback=_show_version, is_eager=True)
]


@app.callback()
def _options(debug: DebugOption = False, version: VersionOption = False) -> None:  # noqa: FBT002
    """Declare the options before a sub-command; `main.run` reads `--debug`."""
