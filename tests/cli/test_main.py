"""How the command ends: by itself, by Ctrl-C at any moment, or with what it can't do."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import trimesh
from cli.models import fit_on_nonsense
from source_folders import PYTHONPATH

import visuohaptic as package
from visuohaptic.fixations.probing import STRATEGIES

ROOT = Path(__file__).parents[2]
# A thread sends the signal, for it knows when the command takes signals, which a clock does not.
PROGRAM = """
import os, signal, sys, threading, time
from visuohaptic.cli.main import main
def send():
    while signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        time.sleep(0.001)
    time.sleep({after})
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=send, daemon=True).start()
sys.argv[1:] = {arguments}
main()
"""


def start(arguments, folder, after):
    program = PROGRAM.format(after=after, arguments=list(map(str, arguments)))
    return subprocess.Popen(
        [sys.executable, "-c", program], cwd=folder, env={**os.environ, "PYTHONPATH": PYTHONPATH},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip


def files_in(folder):
    return set(folder.rglob("*"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("stopped")
    trimesh.creation.torus(1, 0.4, 16, 8).export(folder / "ring.obj")
    for name in ("meshes", "params.yaml"):
        (folder / name).symlink_to(ROOT / name)
    fit_on_nonsense(folder / "results" / "models")
    return folder


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "after"),
    [
        (("touch", "ring.obj", "--viewpoints", 1024), 0.02),
        (("touch", "ring.obj", "--viewpoints", 1024), 0.7),
        (("recognise", "ring.obj", "--viewpoints", 1024), 0.5),
        (("meshes", "check", "--set", "paper"), 0.5),
    ],
)
def test_ctrl_c_stops_every_command_at_any_moment_and_leaves_nothing(folder, arguments, after):
    before = files_in(folder)
    process = start(arguments, folder, after)
    _, said = process.communicate(timeout=60)
    assert (process.returncode, said) == (130, "stopped.\n")
    assert files_in(folder) == before


# What Python calls at odd moments, where an exception is lost: in imports, of objects that go, and at its end.
ODD_MOMENTS = {
    "where exceptions are swallowed": """
try:
    interrupt()
except BaseException:
    pass
""",
    "when an object goes": """
class Gone:
    def __del__(self):
        interrupt()
Gone()
""",
    "within a library's long computation": """
import hashlib, threading
threading.Thread(target=lambda: (time.sleep(0.2), interrupt())).start()
hashlib.pbkdf2_hmac("sha256", b"a", b"a", 2**31 - 1)
""",
    "at the end of threads": """
import threading
threading.Thread(target=lambda: (threading.main_thread().join(), interrupt())).start()
sys.exit()
""",
    "at the end of the process": """
import atexit
atexit.register(interrupt)
sys.exit()
""",
}


@pytest.mark.parametrize("moment", ODD_MOMENTS)
def test_ctrl_c_at_an_odd_moment_prints_no_trace(tmp_path, moment):
    program = f"""
import os, signal, sys, time
from visuohaptic.interrupts import end_at_interrupt
def interrupt():
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(0.3)
end_at_interrupt(lambda: None)
{ODD_MOMENTS[moment]}
time.sleep(30)
"""
    ended = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, timeout=20, check=False, text=True,
        env={**os.environ, "PYTHONPATH": PYTHONPATH}, capture_output=True,
    )  # fmt: skip
    assert (ended.returncode, ended.stderr) in {(130, "stopped.\n"), (0, "")}


def test_the_strategies_of_the_help_are_those_of_the_parameters(visuohaptic):
    shown = visuohaptic("touch", "--help").out
    assert all(strategy in shown for strategy in STRATEGIES.names)
    assert "…" not in shown


@pytest.mark.parametrize("arguments", [["--version"], ["--version", "touch", "mug.obj"]])
def test_the_version_is_that_of_the_package(visuohaptic, arguments):
    ended = visuohaptic(*arguments)
    assert (ended.code, ended.out) == (0, f"visuohaptic {package.__version__}\n")
