"""The process behind warm starts: it imports what scripts import, and forks for each of them.

It knows nothing about the scripts. The first of a kind runs in a fork that does its own imports
and reports them; before the second of its kind the server imports the same modules. So a
script that runs once costs nothing more, and one that runs a hundred times imports twice.

A fork continues with the parent's memory, so its results equal those of a normal process only if
the parent has done nothing but import, and the imported modules equal the files on disk. If an
import starts a thread, which a fork would lose, or a module of this package has been edited, the
server ends, and later scripts start as normal processes.

``python -m visuohaptic_workflow.fork_server LISTENER`` takes a listening socket by its number and ends with its
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

from visuohaptic.interrupts import STOPPED, unblock_interrupts
from visuohaptic_workflow.stopping import interrupts_tidy_up, is_interrupted
from visuohaptic_workflow.warm_start import STARTED, THREADS, is_of_this_user, mount_namespace

PACKAGES = ("contourlets", "visuohaptic", "visuohaptic_workflow")

_FORK_SAFE_THREADS = {"jemalloc_bg_thd"}  # pyarrow's; jemalloc itself brings it through a fork
_SECONDS_TO_CLEAN_UP = 5.0
_SECONDS_TO_ASK = 10.0
_LONGEST_REQUEST = 1 << 20  # bytes


@dataclass(frozen=True)
class Request:
    """A request of a process to run a script.

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
    mounts : str
        The file systems that it sees; a container has its own.
    files : tuple of int
        The descriptors of its standard input, output and error.
    """

    script: str
    folder: str
    environment: dict[str, str]
    prefix: str
    mounts: str
    files: tuple[int, ...]

    @property
    def suits_this_process(self) -> bool:
        """Whether a fork meets the request: the same Python, and the same number of threads.

        Libraries read their number of threads once, when they are loaded.
        """
        same_threads = all(os.environ.get(name) == self.environment.get(name) for name in THREADS)
        same_place = self.prefix == sys.prefix and self.mounts == mount_namespace()
        return same_place and same_threads

    @property
    def kind(self) -> str:
        """The kind of script, which decides its imports: `touches.py` of `tmp7x2.touches.py`."""
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
        self._selector = selectors.DefaultSelector()
        self._lessons: dict[str, list[str]] = {}
        self._left_to_scripts: set[str] = set()
        self._environment = dict(os.environ)
        self._versions = _versions_of_modules()

    def serve(self) -> None:
        """Run requests until the lifeline ends or forks are no longer safe."""
        self._selector.register(self._listener, selectors.EVENT_READ)
        self._selector.register(self._lifeline, selectors.EVENT_READ)
        while True:
            for key, _ in self._selector.select():
                if key.fd == self._lifeline:
                    return
                if key.fd != self._listener.fileno():
                    self._hear(key)
                    continue
                connection, _ = self._listener.accept()
                with connection:
                    request = _receive_request(connection)
                    if request is None:
                        continue
                    self._learn(request.kind)
                    if reason := self._reason_to_end(request):
                        sys.stderr.write(
                            f"{reason}; from now on jobs start as normal processes, which is slower.\n"
                        )
                        return
                    self._fork(connection, request)

    def _reason_to_end(self, request: Request) -> str | None:
        if _threads_that_a_fork_would_lose():
            return f"{request.kind} imports what starts threads"
        found = _versions_of_modules()
        if edited := [name for name, version in self._versions.items() if found[name] != version]:
            return f"{edited[0]} was edited"
        return None

    def _hear(self, key: selectors.SelectorKey) -> None:
        """Take the next piece of a report, whose last one ends a line.

        Its end is not waited for: a process that the script has left behind may keep it open.
        """
        kind, heard = key.data
        piece = os.read(key.fd, 65536)
        heard += piece
        whole = heard.endswith(b"\n")
        if piece and not whole:
            return
        self._selector.unregister(key.fd)
        os.close(key.fd)
        # A script that was killed has reported nothing, or a part.
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
            except Exception:  # noqa: BLE001 - the script then imports it itself, and reports the error
                self._left_to_scripts.add(name)
        if lesson:
            gc.freeze()
            self._versions = _versions_of_modules() | self._versions

    def _fork(self, connection: socket.socket, request: Request) -> None:
        """Fork for a request, and listen to what the fork will report."""
        report, writer = os.pipe()
        not_its_own = [report, *(key.fd for key in self._selector.get_map().values())]
        imported = dict(os.environ.items() - self._environment.items())
        try:
            if os.fork() == 0:
                _run(request, imported, connection, writer, not_its_own)
        except OSError as error:
            sys.stderr.write(f"{request.kind} starts as a normal process: {error}.\n")
        for file in (writer, *request.files):
            os.close(file)
        self._selector.register(report, selectors.EVENT_READ, (request.kind, bytearray()))


def _receive_request(connection: socket.socket) -> Request | None:
    """Give a request that a fork can meet; None where it can't, or where none arrives."""
    if not is_of_this_user(connection):
        return None
    connection.settimeout(_SECONDS_TO_ASK)
    files: list[int] = []
    # A bad request must not stop the server.
    with suppress(Exception):
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
    others = set()
    for task in tasks.iterdir():
        with suppress(FileNotFoundError):  # it has ended
            if task.name != str(os.getpid()):
                others.add((task / "comm").read_text().strip())
    return others - _FORK_SAFE_THREADS


def _versions_of_modules() -> dict[str, tuple[int, int] | None]:
    """Give time and size of each module of this package that is imported; None where it is gone."""
    versions: dict[str, tuple[int, int] | None] = {}
    for name, module in list(sys.modules.items()):
        if name.partition(".")[0] in PACKAGES and (file := getattr(module, "__file__", None)):
            try:
                found = Path(file).stat()
            except OSError:
                versions[name] = None
            else:
                versions[name] = (found.st_mtime_ns, found.st_size)
    return versions


def _run(
    request: Request,
    imported: dict[str, str],
    connection: socket.socket,
    writer: int,
    not_its_own: list[int],
) -> NoReturn:
    """Run a script as the interpreter would, and end this process."""
    status = 1
    try:
        for file in not_its_own:
            os.close(file)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        interrupts_tidy_up()
        for number, file in enumerate(request.files):
            os.dup2(file, number)
            os.close(file)
        os.environ.clear()
        # Libraries set variables where there are none when they are imported.
        os.environ.update({**imported, **request.environment})
        tempfile.tempdir = None  # the environment names it, and a library may have asked already
        if "numpy.random" in sys.modules:
            sys.modules["numpy.random"].seed()  # Python's own generator does this by itself
        connection.sendall(STARTED)
        threading.Thread(target=_end_with, args=(connection,), daemon=True).start()
        known = set(sys.modules)
        report = os.fdopen(writer, "wb")
        # What the script forks must not keep the ends open that others wait for.
        os.register_at_fork(after_in_child=connection.close)
        os.register_at_fork(after_in_child=report.close)
        status = _status_of(request, connection)
        threading._shutdown()  # type: ignore[attr-defined] # the interpreter joins threads first
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        atexit._run_exitfuncs()  # os._exit runs none, and libraries tidy up there
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        # The server may have ended.
        with suppress(OSError), report:
            report.write(json.dumps(_imported_since(known)).encode() + b"\n")
        connection.sendall(bytes([status]))
    finally:
        # A child must never return into the server loop.
        os._exit(status)


def _status_of(request: Request, connection: socket.socket) -> int:
    """Run a script, and give the exit status that Python would end with."""
    try:
        os.chdir(request.folder)
        sys.argv = [request.script]
        sys.path.insert(0, str(Path(request.script).parent))
        runpy.run_path(request.script, run_name="__main__")
    except SystemExit as stop:
        if stop.code is None or isinstance(stop.code, int):
            return (stop.code or 0) & 0xFF
        sys.stderr.write(f"{stop.code}\n")
        return 1
    except BaseException as error:  # noqa: BLE001 - this is where Python itself would print it
        if is_interrupted() or _is_given_up(connection):
            return STOPPED
        traceback.print_exception(error.with_traceback(_from_script_on(error.__traceback__)))
        return 1
    return 0


def _is_given_up(connection: socket.socket) -> bool:
    """Whether the process that handed over a script has ended, which deletes the script, too."""
    with suppress(BlockingIOError):
        return not connection.recv(1, socket.MSG_PEEK | socket.MSG_DONTWAIT)
    return False


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
    # Interrupts are for the scripts. Ended forks are reaped by the kernel.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    unblock_interrupts()
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    with socket.socket(fileno=int(listener)) as listening:
        ForkServer(listening, sys.stdin.fileno()).serve()


if __name__ == "__main__":
    main(sys.argv[1])
