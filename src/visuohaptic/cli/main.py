"""How the command `visuohaptic` starts and ends; everything else is imported once Ctrl-C is heeded."""

from __future__ import annotations

import os
import sys
from contextlib import suppress

from visuohaptic.base.atomic_files import remove_unfinished
from visuohaptic.cli import DEBUG
from visuohaptic.io.interrupts import end_at_interrupt


def main() -> None:
    """Run the command, and then end the process, which Ctrl-C may do before, with status 130."""
    end_at_interrupt(remove_unfinished)
    run(sys.argv[1:])


def run(arguments: list[str]) -> None:
    """Run the command; end with 0, 1 (failed) or 2 (wrong use), an error in one sentence.

    A reader that closes the pipe early has seen enough: that is no error.
    """
    debug = DEBUG in arguments[: arguments.index("--")] if "--" in arguments else DEBUG in arguments
    if debug:
        arguments.remove(DEBUG)
    from visuohaptic.cli.commands import app
    from visuohaptic.cli.printing import say_error

    try:
        try:
            app(arguments, prog_name="visuohaptic")
        except SystemExit as end:
            # Typer ends with 1 where a pipe breaks, for example of `--help`.
            broken = isinstance(end.__context__, BrokenPipeError)
            raise SystemExit(0 if broken or not _flush() else end.code) from None
    except Exception as error:
        if debug:
            raise
        say_error(error)
        with suppress(OSError):  # what can't be written is given up, and named above
            _flush()
        raise SystemExit(1) from None


def _flush() -> bool:
    """Write out what was printed; tell whether anyone took it."""
    try:
        sys.stdout.flush()
    except OSError as error:
        # The interpreter flushes once more at its end, and would complain.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):
            return False
        raise
    return True
