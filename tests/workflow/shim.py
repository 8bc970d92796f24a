"""Ask the server of `quick_commands` to run a command; imports little, for commands that DVC starts."""

import json
import os
import socket
import sys
from types import SimpleNamespace


def ask(address, argv, folder, environment):
    """Let the server run a command in a folder; return its ``returncode`` and ``stdout``, with standard error."""
    with socket.socket(socket.AF_UNIX) as connection:
        connection.connect(str(address))
        request = {"argv": [*map(str, argv)], "folder": str(folder), "environment": environment}
        connection.sendall(json.dumps(request).encode() + b"\n")
        with connection.makefile() as stream:
            return SimpleNamespace(**json.loads(stream.readline()))


def run(name, address):
    """Stand for a command on PATH: let the server run it with the arguments of this process."""
    answer = ask(address, [name, *sys.argv[1:]], os.getcwd(), dict(os.environ))  # noqa: PTH109 - pathlib takes longer
    sys.stdout.write(answer.stdout)
    sys.exit(answer.returncode)
