"""How Ctrl-C ends commands and jobs."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable

STOPPED = 130
"""Exit status of a command that the user stopped: 128 + SIGINT, as in shells."""

_CLEAR_LINE = "\r\033[K"  # clears a progress bar


def end_at_interrupt(tidy_up: Callable[[], None]) -> None:
    """Install a handler of Ctrl-C that calls `tidy_up`, prints one line, and ends the process with status `STOPPED`.

    No KeyboardInterrupt is raised: libraries may catch it, and callbacks may print it and continue.
    """

    def end(*_: object) -> None:
        tidy_up()
        clear = _CLEAR_LINE if sys.stderr.isatty() else ""
        os.write(2, f"{clear}stopped.\n".encode())
        os._exit(STOPPED)

    signal.signal(signal.SIGINT, end)
