"""The command `visuohaptic`: its sub-commands, and how it ends."""

from __future__ import annotations

import os
import sys
from typing import Annotated

import typer

import visuohaptic
from visuohaptic.cli import compare, explore, meshes, report
from visuohaptic.cli.printing import say, sentence_of

DEBUG = "--debug"

app = typer.Typer(
    help="Look at a 3D object, touch it where the eye would rest, and name it from touch alone.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
app.command()(explore.touch)
app.command()(explore.recognise)
app.command()(report.report)
app.command()(compare.compare)
app.add_typer(meshes.app, name="meshes")


def _show_version(wanted: bool) -> None:  # noqa: FBT001 - typer's form of a callback
    if wanted:
        say(f"visuohaptic {visuohaptic.__version__}")
        raise typer.Exit


VersionOption = Annotated[
    bool,
    typer.Option("--version", help="Show the version.", callback=_show_version, is_eager=True),
]
DebugOption = Annotated[bool, typer.Option(DEBUG, help="Show where an error arose.")]


@app.callback()
def _options(debug: DebugOption = False, version: VersionOption = False) -> None:  # noqa: FBT002
    """Take the options that stand before a sub-command; `main` looks for `--debug` itself."""


def main() -> None:
    """Run the command; end with 0, 1 (failed) or 2 (wrong use), an error in one sentence.

    A reader that closes the pipe early has seen enough: that is no error.
    """
    arguments = sys.argv[1:]
    debug = DEBUG in arguments[: arguments.index("--")] if "--" in arguments else DEBUG in arguments
    if debug:
        arguments.remove(DEBUG)
    try:
        app(arguments, prog_name="visuohaptic")
    except SystemExit as end:
        # Typer ends with 1 where a pipe breaks, for example of `--help`.
        broken = isinstance(end.__context__, BrokenPipeError)
        raise SystemExit(0 if broken or not _flush() else end.code) from None
    except Exception as error:
        if debug:
            raise
        sys.stderr.write(f"error: {sentence_of(error)}\n")
        raise SystemExit(1) from None


def _flush() -> bool:
    """Write out what was printed; tell whether anyone took it."""
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        # The interpreter flushes once more at its end, and would complain.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return False
    return True
