"""Ctrl-C stops the command at any moment, with one line and status 130."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from types import FrameType

from visuohaptic.interrupts import CLEAR_LINE, STOPPED, act_at_interrupt

_INTERRUPT = "SIGUSR2"
_IMPORT = "<frozen importlib._bootstrap>"
_SECONDS_TO_NOTICE = 0.02
_SECONDS_TO_TIDY_UP = 1.0
_SECONDS_TO_END = 5.0


class _Command:
    """What is known of the command in this process."""

    is_over = False
    is_asked_to_stop = False
    next_interruption = 0.0
    decided = threading.Lock()


def stop_at_ctrl_c(command: Callable[[], None]) -> None:
    """Let Ctrl-C end a command, and then this process: files are left whole, and nothing goes on.

    An exception may be swallowed, or printed where nothing can catch it. So another thread takes
    Ctrl-C: it interrupts the main thread, again each second, lets nothing of this be seen, and ends
    the process itself where that does not help. After the command's end Ctrl-C changes nothing.
    Raises `SystemExit` with status 130.
    """
    try:
        if sys.platform != "win32":  # Typer stops there
            _take_interrupts()
        command()
    except BaseException:
        if not _Command.is_asked_to_stop:
            raise
    finally:
        _Command.is_over = True
        # Python forgets its own handlers before it ends, but not that a signal is ignored.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    with _Command.decided:
        if _Command.is_asked_to_stop:
            raise SystemExit(STOPPED)


def _take_interrupts() -> None:
    signal.signal(getattr(signal, _INTERRUPT), _interrupt)
    # At the end nothing can be imported that the main thread is importing.
    from visuohaptic.whole_files import remove_unfinished

    act_at_interrupt(lambda _: _stop(remove_unfinished))


def _interrupt(_signal: int, frame: FrameType | None) -> None:
    """Interrupt the main thread, but no import: libraries go on without what they could not import."""
    now = time.monotonic()
    if _Command.is_over or now < _Command.next_interruption or _is_importing(frame):
        return
    _Command.next_interruption = now + _SECONDS_TO_TIDY_UP
    raise KeyboardInterrupt


def _is_importing(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename == _IMPORT:
            return True
        frame = frame.f_back
    return False


def _stop(remove_unfinished: Callable[[], None]) -> None:
    with _Command.decided:
        if _Command.is_over:
            return
        _Command.is_asked_to_stop = True
        clear = CLEAR_LINE if sys.stderr.isatty() else ""
        os.write(2, f"{clear}stopped.\n".encode())
        # What fails from now on fails because of the stop.
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    limit = time.monotonic() + _SECONDS_TO_END
    while time.monotonic() < limit:
        signal.pthread_kill(threading.main_thread().ident or 0, getattr(signal, _INTERRUPT))
        time.sleep(_SECONDS_TO_NOTICE)
    remove_unfinished()
    os._exit(STOPPED)
