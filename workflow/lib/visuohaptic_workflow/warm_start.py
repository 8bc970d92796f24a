"""Warm starts: a script runs in a fork of a process that has imported what such scripts import.

A job of half a second would otherwise take another two to start Python and import its libraries.
This is the side of those who start; `visuohaptic_workflow.fork_server` is the process that forks.
"""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

# Every script that starts waits for what is imported up here; so all else is imported late.
if TYPE_CHECKING:
    from pathlib import Path
    from socket import socket
    from subprocess import Popen

ADDRESS = "VISUOHAPTIC_WARM_START"
"""The variable of the environment that names the server's socket, which is no file: none is left."""

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Variables that set the number of threads of numerical libraries; the server's is 1."""

STARTED = b"started"
"""What the server answers once a script runs; its exit status, one byte, is all that follows."""


_SECONDS_TO_END = 10.0


def offer_warm_starts() -> None:
    """Start a server for the processes that this one starts; it ends when this one does.

    From now on `hand_over` finds it, in this process and in all that inherit its environment.
    Nothing is started on other systems than Linux, where forks of so large a process are not
    safe. If the system refuses, a message says so, and jobs start as normal processes.
    """
    if sys.platform != "linux":
        return
    import atexit
    import uuid
    from functools import partial

    from visuohaptic_workflow.stopping import before_end

    address = f"visuohaptic-{uuid.uuid4()}"
    try:
        server = _start_server(address)
    except OSError as error:
        sys.stderr.write(
            f"Warm start unavailable ({error}); jobs start as normal processes, which is slower.\n"
        )
        return
    os.environ[ADDRESS] = address
    # The server's standard input stays open as long as this process lives; its end is the server's.
    atexit.register(_end_server, server)
    before_end(partial(_end_server, server))


def _start_server(address: str) -> Popen[bytes]:
    import signal
    import socket
    import subprocess

    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(f"\0{address}")
        listener.listen()
        number = listener.fileno()
        # The server takes over this mask, until it is ready to ignore interrupts.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        try:
            return subprocess.Popen(  # noqa: S603 - a module of this package
                # Without -P it would import what happens to lie in this folder.
                [sys.executable, "-P", "-m", "visuohaptic_workflow.fork_server", str(number)],
                env={**os.environ, **dict.fromkeys(THREADS, "1")},
                stdin=subprocess.PIPE,
                pass_fds=[number],
            )
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _end_server(server: Popen[bytes]) -> None:
    import subprocess

    try:
        server.communicate(timeout=_SECONDS_TO_END)
    except subprocess.TimeoutExpired:
        server.kill()
        server.wait()


def hand_over(script: str | Path) -> int | None:
    """Let the server run a script with this process's files, folder and environment.

    The script is interrupted when this process ends.

    Parameters
    ----------
    script : path
        A Python file.

    Returns
    -------
    int or None
        The script's exit status; None where no server took it, and nothing was run.
    """
    if ADDRESS not in os.environ:
        return None
    import json
    import signal
    import socket

    request = {
        "script": str(script),
        "folder": os.getcwd(),  # noqa: PTH109 - pathlib would make each start slower
        "environment": dict(os.environ),
        "prefix": sys.prefix,
        "mounts": mount_namespace(),
    }
    with socket.socket(socket.AF_UNIX) as connection:
        try:
            connection.connect(f"\0{os.environ[ADDRESS]}")
            if not is_of_this_user(connection):
                return None
            message = json.dumps(request).encode() + b"\n"
            sent = socket.send_fds(connection, [message], [0, 1, 2])
            connection.sendall(message[sent:])
            if _receive(connection, len(STARTED)) != STARTED:
                return None
        except OSError:
            return None
        # An interrupt ends the script along with this process; only the script prints a message.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
        status = _receive(connection, 1)
    if not status:
        sys.stderr.write(f"error: the process that ran {script} ended without an answer.\n")
        return 1
    return status[0]


def mount_namespace() -> str:
    """Name the set of file systems that this process sees; a container's is another."""
    return os.readlink("/proc/self/ns/mnt")  # noqa: PTH115 - as above


def is_of_this_user(connection: socket) -> bool:
    """Whether the process at the other end is of the same user: any user can reach the socket."""
    import socket
    import struct

    process_user_group = struct.Struct("3i")
    credentials = connection.getsockopt(
        socket.SOL_SOCKET, socket.SO_PEERCRED, process_user_group.size
    )
    return process_user_group.unpack(credentials)[1] == os.getuid()


def _receive(connection: socket, length: int) -> bytes:
    """Give so many bytes, or fewer where the other side ends."""
    received = b""
    while len(received) < length and (more := connection.recv(length - len(received))):
        received += more
    return received
