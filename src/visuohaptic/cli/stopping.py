"""Ctrl-C stops the command at any moment, with one line and status 130."""

from __future__ import annotations

import atexit
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

STOPPED = 130
"""Status of a command that the user stopped, as shells have it: 128 + SIGINT."""

_IMPORT = "<frozen importlib._bootstrap>"
_SECONDS_TO_IMPORT = 0.01
_SECONDS_TO_CLEAN_UP = 1.0


@contextmanager
def stops_at_ctrl_c() -> Iterator[Stop]:
    """Let Ctrl-C end what is done here: files are left whole, and nothing goes on.

    Libraries import others inside ``except BaseException`` and go on without them, which would
    swallow the stop; so a stop during an import waits for its end. Where anything else
    swallows it, it comes again.

    Yields
    ------
    Stop
        Whether the user asked to stop: what fails from then on is no error.

    Raises
    ------
    SystemExit
        With status 130, after one line on standard error.
    """
    stop = Stop()
    try:
        before = signal.signal(signal.SIGINT, stop.receive)
    except ValueError:  # signals reach the main thread alone
        yield stop
        return
    # The interpreter's own end is no work that could be stopped.
    atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)
    try:
        yield stop
    except BaseException:
        if not stop.asked:
            raise
    finally:
        stop.rest()
        signal.signal(signal.SIGINT, signal.SIG_IGN if stop.asked else before)
    if stop.asked:
        sys.stderr.write("stopped.\n")
        raise SystemExit(STOPPED)


class Stop:
    """Whether the user asked to stop, and what brings it about."""

    def __init__(self) -> None:
        self.asked = False

    def receive(self, _signal: int, frame: FrameType | None) -> None:
        """Stop, or come again where an import is under way."""
        self.asked = True
        if _is_importing(frame):
            self._come_again(_SECONDS_TO_IMPORT)
            return
        self._come_again(_SECONDS_TO_CLEAN_UP)
        raise KeyboardInterrupt

    def rest(self) -> None:
        """Come no more."""
        if self.asked and hasattr(signal, "setitimer"):
            signal.setitimer(signal.ITIMER_REAL, 0.0)

    def _come_again(self, seconds: float) -> None:
        if not hasattr(signal, "setitimer"):  # Windows
            raise KeyboardInterrupt
        signal.signal(signal.SIGALRM, self.receive)
        signal.setitimer(signal.ITIMER_REAL, seconds)


def _is_importing(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename == _IMPORT:
            return True
        frame = frame.f_back
    return False
