"""The process behind warm starts: it imports what scripts import, and forks for each of them.

It is told nothing about the scripts. The first of a kind runs in a fork that imports all by itself
and reports what that was; before the second of its kind the server imports the same. So a
script that runs once costs nothing more, and one that runs a hundred times imports twice.

A fork goes on with the parent's memory, so its results are those of a process of its own only as
long as the parent has done nothing but import. It does nothing else, and where an import starts a
thread, which a fork would lose, it ends, and scripts start by themselves from there on.

``python -m visuohaptic.fork_server LISTENER`` takes a listening socket by its number and ends with its
standard input.
"""

from __future__ import annotations

import atexit
import gc
import importlib
import json
import os
import runpy
import selectors
import signal
import socket
import sys
import tempfile
import threading
import time
import traceback
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import NoReturn

from visuohaptic.warm_start import STARTED, is_of_this_user

_FORK_SAFE_THREADS = {"jemalloc_bg_thd"}  # pyarrow's; jemalloc itself brings it through a fork
_SECONDS_TO_CLEAN_UP = 5.0
_SECONDS_TO_ASK = 10.0
_LONGEST_REQUEST = 1 << 20  # bytes
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass(frozen=True)
class Request:
    """What a process hands over.

    Attributes
    ----------
    script : str
        The Python file.
    folder : str
        Where to run it.
    environment : dict of str
        Its environment.
    prefix : str
        The Python installation that was asked for.
    files : tuple of int
        The descriptors of its standard input, output and error.
    """

    script: str
    folder: str
    environment: dict[str, str]
    prefix: str
    files: tuple[int, ...]

    @property
    def suits_this_process(self) -> bool:
        """Whether a fork would be what was asked for: this Python, and as many threads.

        Libraries read their number of threads once, when they are loaded.
        """
        same_threads = all(os.environ.get(name) == self.environment.get(name) for name in _THREADS)
        return self.prefix == sys.prefix and same_threads

    @property
    def kind(self) -> str:
        """What scripts that import alike have in common: `touches.py` of `tmp7x2.touches.py`."""
        return Path(self.script).name.partition(".")[2]


class ForkServer:
    """Run scripts in forks of this process.

    Parameters
    ----------
    listener : socket.socket
        Where requests arrive.
    lifeline : int
        A file descriptor that nothing is written to; the server ends with it.
    """

    def __init__(self, listener: socket.socket, lifeline: int) -> None:
        self._listener = listener
        self._lifeline = lifeline
        self._lessons: dict[str, list[str]] = {}
        self._left_to_scripts: set[str] = set()

    def serve(self) -> None:
        """Run what is handed over, until the lifeline ends or an import has started a thread."""
        with selectors.DefaultSelector() as selector:
            selector.register(self._listener, selectors.EVENT_READ)
            selector.register(self._lifeline, selectors.EVENT_READ)
            while True:
                for key, _ in selector.select():
                    if key.fd == self._lifeline:
                        return
                    if key.fd != self._listener.fileno():
                        self._hear(selector, key)
                        continue
                    connection, _ = self._listener.accept()
                    with connection:
                        request = _receive_request(connection)
                        if request is None:
                            continue
                        self._learn(request.kind)
                        if _threads_that_a_fork_would_lose():
                            sys.stderr.write(
                                f"{request.kind} imports what starts threads, so from here on jobs "
                                f"start by themselves.\n"
                            )
                            return
                        report = self._fork(connection, request)
                        selector.register(report, selectors.EVENT_READ, (request.kind, bytearray()))

    def _hear(self, selector: selectors.BaseSelector, key: selectors.SelectorKey) -> None:
        """Take the next piece of a report, whose last one ends a line.

        Its end is not waited for: a process that the script has left behind may keep it open.
        """
        kind, heard = key.data
        piece = os.read(key.fd, 65536)
        heard += piece
        whole = heard.endswith(b"\n")
        if piece and not whole:
            return
        selector.unregister(key.fd)
        os.close(key.fd)
        # A script that was killed has told nothing, or half of it.
        if whole:
            self._lessons[kind] = json.loads(heard)

    def _learn(self, kind: str) -> None:
        """Import what the last script of this kind had to import by itself."""
        lesson = self._lessons.pop(kind, [])
        for name in lesson:
            if name in sys.modules or name in self._left_to_scripts:
                continue
            try:
                importlib.import_module(name)
            except Exception:  # noqa: BLE001 - whatever it is, a script can do it by itself
                self._left_to_scripts.add(name)
        if lesson:
            gc.freeze()

    def _fork(self, connection: socket.socket, request: Request) -> int:
        """Fork for a request, and give the descriptor that the fork will report to."""
        report, writer = os.pipe()
        if os.fork() == 0:
            self._listener.close()
            _run(request, connection, writer)
        for file in (writer, *request.files):
            os.close(file)
        return report


def _receive_request(connection: socket.socket) -> Request | None:
    """Give a request that a fork can meet; None where it can't, or where none arrives."""
    if not is_of_this_user(connection):
        return None
    connection.settimeout(_SECONDS_TO_ASK)
    files: list[int] = []
    with suppress(OSError, ValueError, TypeError):
        message, files, _, _ = socket.recv_fds(connection, 65536, 3)
        while not message.endswith(b"\n") and len(message) < _LONGEST_REQUEST:
            more = connection.recv(65536)
            if not more:
                break
            message += more
        request = Request(**json.loads(message), files=tuple(files))
        connection.settimeout(None)
        if request.suits_this_process and len(files) == 3:
            return request
    for file in files:
        os.close(file)
    return None


def _threads_that_a_fork_would_lose() -> set[str]:
    tasks = Path("/proc/self/task")
    own = str(os.getpid())
    others = {(task / "comm").read_text().strip() for task in tasks.iterdir() if task.name != own}
    return others - _FORK_SAFE_THREADS


def _run(request: Request, connection: socket.socket, writer: int) -> NoReturn:
    """Run a script as the interpreter would, and end this process."""
    status = 1
    try:
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        for number, file in enumerate(request.files):
            os.dup2(file, number)
            os.close(file)
        os.environ.clear()
        os.environ.update(request.environment)
        tempfile.tempdir = None  # the environment names it, and a library may have asked already
        connection.sendall(STARTED)
        threading.Thread(target=_end_with, args=(connection,), daemon=True).start()
        known = set(sys.modules)
        status = _status_of(request)
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        atexit._run_exitfuncs()  # os._exit runs none, and libraries tidy up there
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        with os.fdopen(writer, "wb") as report:
            report.write(json.dumps(_imported_since(known)).encode() + b"\n")
        connection.sendall(bytes([status]))
    finally:
        # Whatever happens, the server's own code is not for a fork to go on with.
        os._exit(status)


def _status_of(request: Request) -> int:
    """Run a script, and give the exit status that Python would end with."""
    try:
        os.chdir(request.folder)
        sys.argv = [request.script]
        sys.path[0] = str(Path(request.script).parent)
        runpy.run_path(request.script, run_name="__main__")
    except SystemExit as stop:
        if stop.code is None or isinstance(stop.code, int):
            return (stop.code or 0) & 0xFF
        sys.stderr.write(f"{stop.code}\n")
        return 1
    except BaseException as error:  # noqa: BLE001 - this is where Python itself would print it
        traceback.print_exception(error.with_traceback(_from_script_on(error.__traceback__)))
        return 1
    return 0


def _from_script_on(trace: TracebackType | None) -> TracebackType | None:
    """Leave out of a traceback what ran the script."""
    runners = {__file__, runpy.run_path.__code__.co_filename}
    while trace is not None and trace.tb_frame.f_code.co_filename in runners:
        trace = trace.tb_next
    return trace


def _imported_since(known: set[str]) -> list[str]:
    return [
        name
        for name, module in list(sys.modules.items())
        if name not in known and getattr(module, "__spec__", None) is not None
    ]


def _end_with(connection: socket.socket) -> None:
    """Interrupt this process when the one that handed over its script has ended."""
    with suppress(OSError):
        connection.recv(1)
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(_SECONDS_TO_CLEAN_UP)
    os.kill(os.getpid(), signal.SIGKILL)


def main(listener: str) -> None:
    """Serve until standard input ends; see the module."""
    # An interrupt is for the scripts. Forks that have ended need no one to wait for them.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    with socket.socket(fileno=int(listener)) as listening:
        ForkServer(listening, sys.stdin.fileno()).serve()


if __name__ == "__main__":
    main(sys.argv[1])
