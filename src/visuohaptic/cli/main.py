"""The command `visuohaptic`: its sub-commands, and how it ends."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from visuohaptic.cli import meshes
from visuohaptic.errors import VisuohapticError

app = typer.Typer(
    help="Look at a 3D object, touch it where the eye would rest, and name it from touch alone.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
app.add_typer(meshes.app, name="meshes")


@app.callback()
def _options(
    context: typer.Context,
    debug: Annotated[bool, typer.Option(help="Show where in the program an error arose.")] = False,  # noqa: FBT002
) -> None:
    context.obj = {"debug": debug}


def main() -> None:
    """Run the command; end with 0, 1 (failed) or 2 (wrong use), an error in one sentence."""
    try:
        app()
    except VisuohapticError as error:
        if "--debug" in sys.argv:
            raise
        sys.stderr.write(f"error: {error}\n")
        raise SystemExit(1) from None
