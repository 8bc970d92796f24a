"""What Ctrl-C does to commands and jobs."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable

STOPPED = 130
"""Status of a command that the user stopped, as shells have it: 128 + SIGINT."""

_CLEAR_LINE = "\r\033[K"  # of a progress bar


def end_at_interrupt(tidy_up: Callable[[], None]) -> None:
    """Let Ctrl-C end this process at once, with one line and status `STOPPED`.

    An exception may be swallowed, or printed where nothing can catch it; so there is none.
    """

    def end(*_: object) -> None:
        tidy_up()
        clear = _CLEAR_LINE if sys.stderr.isatty() else ""
        os.write(2, f"{clear}stopped.\n".encode())
        os._exit(STOPPED)

    signal.signal(signal.SIGINT, end)
