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
    press,
    report,
    tables,
)
from visuohaptic.cli.printing import say

app = typer.Typer(
    help="Look at a 3D object, touch it where the eye would rest, and recognise it from touch alone.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
for command in (
    *(explore.touch, explore.recognise, press.press, evaluate.evaluate, report.report),
    *(compare.compare, export.export, tables.tables),
):
    app.command()(command)
app.add_typer(meshes.app, name="meshes")


DebugOption = Annotated[bool, typer.Option(DEBUG, help="Show where an error arose.")]


def _show_version(asked: bool) -> None:  # noqa: FBT001 - as typer calls it
    if asked:
        say(f"visuohaptic {__version__}")
        raise typer.Exit


VersionOption = Annotated[
    bool, typer.Option("--version", help="Show the version.", callback=_show_version, is_eager=True)
]


@app.callback()
def _options(debug: DebugOption = False, version: VersionOption = False) -> None:  # noqa: FBT002
    """Take the options that stand before a sub-command; `main` looks for `--debug` itself."""
