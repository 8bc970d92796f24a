"""How the command `visuohaptic` starts and ends; everything else is imported once Ctrl-C is heeded."""

from __future__ import annotations

import os
import sys
from contextlib import suppress

from visuohaptic.cli.stopping import Stop, stops_at_ctrl_c

DEBUG = "--debug"


def main() -> None:
    """Run the command; end with 0, 1 (failed), 2 (wrong use) or 130 (stopped), an error in one sentence.

    A reader that closes the pipe early has seen enough: that is no error.
    """
    with stops_at_ctrl_c() as stop:
        _run(sys.argv[1:], stop)


def _run(arguments: list[str], stop: Stop) -> None:
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
        if debug or stop.asked:
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
