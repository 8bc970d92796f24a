"""The command in a process of its own."""

import os
import subprocess
import sys

from source_folders import PYTHONPATH

PROGRAM = "from visuohaptic.cli.main import main; main()"


def start(arguments, folder, program=PROGRAM, stdout=subprocess.PIPE, **environment):
    return subprocess.Popen(
        [sys.executable, "-c", program, *map(str, arguments)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": PYTHONPATH, **environment},
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def run(arguments, folder, **options):
    """Run the command to its end, and return its exit code, standard output and standard error."""
    process = start(arguments, folder, **options)
    try:
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    return process.returncode, out, err
