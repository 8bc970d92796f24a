"""Ctrl-C ends a run at any moment with one line, status 130 and nothing half written."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from workflow.conftest import Experiment
from workflow.test_one_run import wait_for
from workflow.walks import digests, make_experiment

pytestmark = [pytest.mark.workflow, pytest.mark.long]

ROOT = Path(__file__).parents[2]
PATHS = os.pathsep.join(str(ROOT / part) for part in ("src", "workflow/lib"))
STOPPED = "stopped; the same command continues."
STATUS = 130
PLAIN = ["snakemake", "-j2"]
SCREEN = [sys.executable, "-P", "-m", "visuohaptic_workflow.screen", "-j2"]


@pytest.fixture(scope="module")
def fresh(tmp_path_factory):
    """An experiment before anything has run; its scripts are stand-ins."""
    folder = tmp_path_factory.mktemp("fresh") / "experiment"
    make_experiment(folder)
    return Experiment(folder)


@pytest.fixture(scope="module")
def finished(fresh, tmp_path_factory):
    experiment = fresh.copy(tmp_path_factory.mktemp("finished") / "experiment")
    experiment.snakemake()
    return experiment


def start(folder, command):
    paths = os.pathsep.join(str(folder / part) for part in ("src", "workflow/lib"))
    environment = {key: value for key, value in os.environ.items() if not key.startswith("DVC_")}
    environment["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{environment['PATH']}"
    environment["PYTHONPATH"] = paths if command == SCREEN else ""
    return subprocess.Popen(
        command, cwd=folder, env=environment, start_new_session=True, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip


def is_anyone_left(session):
    for process in Path("/proc").glob("[0-9]*"):
        try:
            fields = (process / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[3]) == session and fields[0] != "Z":
            return True
    return False


@pytest.mark.parametrize("command", [PLAIN, SCREEN], ids=["snakemake", "screen"])
@pytest.mark.parametrize(
    "sign",
    [
        ".snakemake/run.lock",
        ".snakemake/locks/*",
        "results/meshes/*/*/*.ply",
        "results/touches/*/*/*.parquet",
    ],
)
def test_ctrl_c_ends_with_one_line_and_the_same_command_continues(
    fresh, finished, tmp_path, command, sign
):
    experiment = fresh.copy(tmp_path / "experiment")
    process = start(experiment.folder, command)
    wait_for(lambda: any(experiment.folder.glob(sign)))
    os.killpg(process.pid, signal.SIGINT)
    output, _ = process.communicate(timeout=60)
    assert process.returncode == 130
    assert output.count(STOPPED) == 1
    assert output.endswith(f"{STOPPED}\n")
    assert "Traceback" not in output
    wait_for(lambda: not is_anyone_left(process.pid), seconds=10)
    assert not list((experiment.folder / "results").rglob(".*"))
    again = start(experiment.folder, command)
    again.communicate(timeout=120)
    assert again.returncode == 0
    assert digests(experiment.folder) == digests(finished.folder)


def test_make_s_screen_stops_while_snakemake_itself_is_still_being_loaded(fresh, tmp_path):
    experiment = fresh.copy(tmp_path / "experiment")
    process = start(experiment.folder, SCREEN)
    maps = Path(f"/proc/{process.pid}/maps")
    # Its imports have begun, and take another second.
    wait_for(lambda: "_asyncio" in maps.read_text())
    os.killpg(process.pid, signal.SIGINT)
    output, _ = process.communicate(timeout=60)
    assert (process.returncode, output) == (130, f"{STOPPED}\n")


def test_an_import_that_is_interrupted_is_no_error_of_its_job(fresh, tmp_path):
    experiment = fresh.copy(tmp_path / "experiment")
    script = experiment.folder / "workflow/scripts/meshes.py"
    swallows = """
import time
from pathlib import Path
from visuohaptic_workflow.jobs import job

with job(snakemake):
    Path("working").touch()
    try:
        time.sleep(60)
    except BaseException:
        raise ImportError("initialization failed")
"""
    script.write_text(swallows)
    process = start(experiment.folder, PLAIN)
    wait_for((experiment.folder / "working").exists)
    os.killpg(process.pid, signal.SIGINT)
    output, _ = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "initialization failed" not in output


def run_until_ctrl_c(folder, program):
    """Run a program that calls `end_at_ctrl_c` first, interrupt it once it has begun, and give its end."""
    start = "from visuohaptic_workflow.stopping import end_at_ctrl_c\nend_at_ctrl_c()\n"
    process = subprocess.Popen(
        [sys.executable, "-c", start + program], cwd=folder, start_new_session=True, text=True,
        env={**os.environ, "PYTHONPATH": PATHS}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    wait_for((folder / "begun").exists)
    os.killpg(process.pid, signal.SIGINT)
    output, _ = process.communicate(timeout=20)
    wait_for(lambda: not is_anyone_left(process.pid), seconds=10)
    return process.returncode, output


def test_what_swallows_every_exception_does_not_swallow_the_stop(tmp_path):
    program = """
import time
from pathlib import Path
Path("begun").touch()
while True:
    try:
        time.sleep(1)
    except BaseException:
        pass
"""
    assert run_until_ctrl_c(tmp_path, program) == (STATUS, f"{STOPPED}\n")


def test_a_job_that_is_just_starting_ends_without_a_word_of_python(tmp_path):
    job = """
import sys, time
from pathlib import Path
Path("begun").touch()
time.sleep(0.5)
from visuohaptic_workflow.stopping import interrupts_tidy_up
try:
    interrupts_tidy_up()
    time.sleep(60)
except KeyboardInterrupt:
    Path("tidied").touch()
    sys.exit(130)
"""
    program = f"""
import subprocess, sys
subprocess.run([sys.executable, "-c", {job!r}])
"""
    assert run_until_ctrl_c(tmp_path, program) == (STATUS, f"{STOPPED}\n")
    assert (tmp_path / "tidied").exists()


def test_no_job_is_started_after_the_stop(tmp_path):
    program = """
import subprocess
from pathlib import Path
for number in range(1000):
    Path("begun").touch()
    Path("jobs").write_text(str(number))
    subprocess.run(["sleep", "60"])
"""
    assert run_until_ctrl_c(tmp_path, program) == (STATUS, f"{STOPPED}\n")
    assert (tmp_path / "jobs").read_text() == "0"


def test_a_stubborn_job_is_killed(tmp_path):
    program = """
import subprocess, sys
from pathlib import Path
job = "import signal, time; from pathlib import Path; signal.signal(signal.SIGINT, signal.SIG_IGN); "
job += "Path('begun').touch(); time.sleep(60)"
subprocess.run([sys.executable, "-c", job])
"""
    assert run_until_ctrl_c(tmp_path, program) == (STATUS, f"{STOPPED}\n")


SCHEDULER = """
import os, signal, threading, time
from visuohaptic_workflow.stopping import end_at_sigterm

class Scheduler:
    lock, ended = threading.Lock(), threading.Event()

    def exit_gracefully(self, *_):
        with self.lock:
            self.ended.set()

scheduler = Scheduler()
signal.signal(signal.SIGTERM, scheduler.exit_gracefully)
{call}
with scheduler.lock:
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(0.1)
print(scheduler.ended.wait(30))
"""


def test_sigterm_ends_a_scheduler_that_holds_its_lock():
    program = SCHEDULER.format(call="end_at_sigterm(scheduler)")
    found = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=True
    )
    assert found.stdout == "True\n"
