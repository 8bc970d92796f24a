"""How the command ends: by itself, by Ctrl-C at any moment, or with what it can't do."""

from pathlib import Path

import pytest
import trimesh
from cli.models import fit_on_nonsense
from cli.processes import run

import visuohaptic as package
from visuohaptic.active.registry import STRATEGIES

ROOT = Path(__file__).parents[2]
# A thread sends the signal, for it knows when the command takes signals, which a clock does not.
PROGRAM = """
import os, signal, threading, time
from visuohaptic.cli.main import main
def send():
    while signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        time.sleep(0.001)
    time.sleep({after})
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=send, daemon=True).start()
main()
"""


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
        (("meshes", "check", "--set", "paper"), 0.05),
    ],
)
def test_ctrl_c_stops_every_command_at_any_moment_and_leaves_nothing(folder, arguments, after):
    before = set(folder.rglob("*"))
    code, _, said = run(arguments, folder, program=PROGRAM.format(after=after))
    assert (code, said) == (130, "stopped.\n")
    assert set(folder.rglob("*")) == before


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
from visuohaptic.io.interrupts import end_at_interrupt
def interrupt():
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(0.3)
end_at_interrupt(lambda: None)
{ODD_MOMENTS[moment]}
time.sleep(30)
"""
    code, _, said = run([], tmp_path, program=program)
    assert (code, said) in {(130, "stopped.\n"), (0, "")}


def test_the_help_has_an_example_and_the_strategies_of_the_parameters(visuohaptic):
    shown = visuohaptic("touch", "--help").out
    assert all(strategy in shown for strategy in STRATEGIES.names)
    assert "…" not in shown
    assert "Example: visuohaptic touch" in shown


def test_the_version_is_that_of_the_package_whatever_else_is_asked(visuohaptic):
    ended = visuohaptic("--version", "touch", "mug.obj")
    assert (ended.code, ended.out) == (0, f"visuohaptic {package.__version__}\n")
