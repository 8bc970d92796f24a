"""What Ctrl-C does to commands and jobs."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Callable

STOPPED = 130
"""Status of a command that the user stopped, as shells have it: 128 + SIGINT."""

_SECONDS_TO_END = 5.0
_CLEAR_LINE = "\r\033[K"  # of a progress bar


def end_at_interrupt(tidy_up: Callable[[], None]) -> None:
    """Let Ctrl-C end this process at once, with one line and status `STOPPED`.

    An exception may be swallowed, or printed where nothing can catch it; so there is none. Processes
    that are started from now on take no interrupt, and end with this one.
    """

    def end(*_: object) -> None:
        tidy_up()
        clear = _CLEAR_LINE if sys.stderr.isatty() else ""
        os.write(2, f"{clear}stopped.\n".encode())
        os._exit(STOPPED)

    def hand_on() -> None:
        signal.sigwait([signal.SIGINT])
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGUSR2)
        # Python calls a handler only once a library's long computation is over.
        time.sleep(_SECONDS_TO_END)
        end()

    signal.signal(signal.SIGINT, end)
    if sys.platform != "win32":
        signal.signal(signal.SIGUSR2, end)
        signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        threading.Thread(target=hand_on, name="ctrl-c", daemon=True).start()
