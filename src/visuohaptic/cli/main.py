"""Entry point of the command `visuohaptic`; installs the handler of Ctrl-C before slow imports."""

from __future__ import annotations

import gc
import os
import sys
from contextlib import suppress

from visuohaptic.base.atomic_files import remove_unfinished
from visuohaptic.base.quick_imports import quick_imports
from visuohaptic.cli import DEBUG
from visuohaptic.io.interrupts import end_at_interrupt


def main() -> None:
    """Run the command and end the process; Ctrl-C ends the process with status 130."""
    end_at_interrupt(remove_unfinished)
    try:
        run(sys.argv[1:])
    finally:
        # The interpreter would look through all objects several times before it ends.
        gc.freeze()


def run(arguments: list[str]) -> None:
    """Run the command; end with status 0, 1 (failed) or 2 (wrong use), and print an error as one sentence.

    A reader that closes the pipe early, such as ``head``, is no error.
    """
    debug = DEBUG in arguments[: arguments.index("--")] if "--" in arguments else DEBUG in arguments
    if debug:
        arguments.remove(DEBUG)
    with quick_imports():
        from visuohaptic.cli.commands import app
        from visuohaptic.cli.printing import say_error

        # Later collections do not look through the imported modules.
        gc.freeze()

    try:
        try:
            app(arguments, prog_name="visuohaptic")
        except SystemExit as end:
            # Typer ends with 1 when a pipe breaks, for example in `--help | head`.
            broken = isinstance(end.__context__, BrokenPipeError)
            raise SystemExit(0 if broken or not _flush() else end.code) from None
    except Exception as error:
        if debug:
            raise
        say_error(error)
        with suppress(OSError):  # the error was printed above
            _flush()
        raise SystemExit(1) from None


def _flush() -> bool:
    """Flush standard output; return whether its reader is still there."""
    try:
        sys.stdout.flush()
    except OSError as error:
        # The interpreter flushes again at its end, and would print an error.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):
            return False
        raise
    return True
