"""Ctrl-C ends a run at any moment, with one line and status 130."""

from __future__ import annotations

import logging
import os
import signal
import sys
import warnings
from types import FrameType
from typing import NoReturn

STOPPED = 130
"""Status of a run that the user stopped, as shells have it: 128 + SIGINT."""

CLEAR_LINE = "\r\033[K"
"""What a terminal needs before a line that may follow a progress bar."""

_IMPORT = "<frozen importlib._bootstrap>"
_SECONDS_TO_IMPORT = 0.01


def end_at_ctrl_c() -> None:
    """Let Ctrl-C end Snakemake: from then on it logs nothing, as what fails then is no error."""
    if not isinstance(signal.getsignal(signal.SIGINT), _Stop):
        signal.signal(signal.SIGINT, _Stop())


def end_if_stopped() -> None:
    """End with status 130 where the user asked to stop; Snakemake itself would end with 1.

    Raises
    ------
    SystemExit
        With status 130.
    """
    stop = signal.getsignal(signal.SIGINT)
    if isinstance(stop, _Stop) and stop.asked:
        raise SystemExit(STOPPED)


def interrupt_once(*_: object) -> NoReturn:
    """Interrupt a job as Python does, but let what it tidies up then come to its end."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    raise KeyboardInterrupt


def is_interrupted() -> bool:
    """Whether `interrupt_once` was called in this process."""
    return signal.getsignal(signal.SIGINT) is signal.SIG_IGN


class _Stop:
    """What Ctrl-C calls."""

    def __init__(self) -> None:
        self.asked = False
        self._said = False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        """Say that the run ends, and end it; the second time at once."""
        if self.asked and number == signal.SIGINT:
            os._exit(STOPPED)
        self.asked = True
        if not self._said:
            self._said = True
            logging.getLogger("snakemake.logging").addFilter(_drop)
            warnings.simplefilter("ignore")  # of what was about to start
            clear = CLEAR_LINE if sys.stderr.isatty() else ""
            os.write(2, f"{clear}stopped; the same command continues.\n".encode())
        # Libraries import others inside `except BaseException`, which would swallow the stop.
        if _is_importing(frame):
            signal.signal(signal.SIGALRM, self)
            signal.setitimer(signal.ITIMER_REAL, _SECONDS_TO_IMPORT)
            return
        _end()


def _end() -> NoReturn:
    raise SystemExit(STOPPED)


def _drop(_: logging.LogRecord) -> bool:
    return False


def _is_importing(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename == _IMPORT:
            return True
        frame = frame.f_back
    return False
