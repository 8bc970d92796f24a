"""One run at a time: what was killed is cleared away, what is at work is respected."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from workflow.conftest import Experiment
from workflow.walks import digests, make_experiment

pytestmark = [pytest.mark.workflow, pytest.mark.long]


def start(experiment, *command):
    """Start a command in a process group of its own."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith("DVC_")}
    environment["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{environment['PATH']}"
    environment.pop("PYTHONPATH", None)
    return subprocess.Popen(
        command, cwd=experiment.folder, env=environment, start_new_session=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip


def wait_for(condition, seconds=120):
    limit = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < limit, "nothing came"
        time.sleep(0.02)


def parts(experiment, table):
    return list((experiment.folder / "results" / table).rglob("[!.]*.parquet"))


@pytest.fixture
def fresh(tmp_path):
    """An experiment before anything has run; its scripts are stand-ins."""
    make_experiment(tmp_path / "experiment")
    return Experiment(tmp_path / "experiment")


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """The same after a whole run."""
    folder = tmp_path_factory.mktemp("finished") / "experiment"
    make_experiment(folder)
    experiment = Experiment(folder)
    experiment.snakemake("dvc_all")
    return experiment


KILLS = [
    (signal.SIGINT, "process", "views"),
    (signal.SIGINT, "group", "touches"),
    (signal.SIGTERM, "process", "features"),
    (signal.SIGKILL, "process", "touches"),
    (signal.SIGKILL, "group", "views"),
]


@pytest.mark.parametrize(("how", "whom", "table"), KILLS)
def test_the_plain_command_goes_on_after_a_run_was_ended(fresh, finished, how, whom, table):
    process = start(fresh, "snakemake", "-j2")
    wait_for(lambda: parts(fresh, table))
    (os.killpg if whom == "group" else os.kill)(process.pid, how)
    process.wait(timeout=300)
    fresh.snakemake("dvc_all")
    assert digests(fresh.folder) == digests(finished.folder)
    assert fresh.planned() == {}


def test_dvc_repro_goes_on_after_it_was_killed(fresh, finished):
    fresh.run("git", "init", "-q")
    process = start(fresh, "dvc", "repro")
    wait_for(lambda: parts(fresh, "views"))
    os.killpg(process.pid, signal.SIGKILL)
    process.wait(timeout=300)
    fresh.run("dvc", "repro")
    assert digests(fresh.folder) == digests(finished.folder)


@pytest.fixture
def at_work(fresh):
    """An experiment whose run is in the middle of its jobs."""
    experiment = fresh
    experiment.run("git", "init", "-q")
    module = experiment.folder / "src/visuohaptic/features/describing.py"
    waits = "import os, time\nif not os.path.exists('go'):\n    time.sleep(60)\n"
    module.write_text(f"{module.read_text()}\n{waits}")
    process = start(experiment, "snakemake", "-j2")
    wait_for(lambda: parts(experiment, "touches"))
    yield experiment
    os.killpg(process.pid, signal.SIGKILL)
    process.wait(timeout=300)


@pytest.mark.parametrize("command", [("snakemake", "-j2"), ("dvc", "repro")])
def test_a_second_run_says_that_the_first_is_at_work(at_work, command):
    before = len(parts(at_work, "touches"))
    result = at_work.run(*command, check=False)
    assert result.returncode != 0
    assert "at work" in result.stdout or "is busy" in result.stdout
    assert len(parts(at_work, "touches")) >= before


def test_a_dry_run_is_possible_beside_a_run(at_work):
    assert "features" in at_work.snakemake("-n").stdout


@pytest.mark.parametrize("sign", ["logs/given.json", "results/meshes/*/*/*.ply"])
def test_after_ctrl_c_nothing_is_half_written_and_the_same_command_continues(fresh, finished, sign):
    process = start(fresh, "snakemake", "-j2")
    wait_for(lambda: any(fresh.folder.glob(sign)))
    os.killpg(process.pid, signal.SIGINT)
    assert process.wait(timeout=60) != 0
    assert not [
        file
        for file in (fresh.folder / "results").rglob(".*")
        if file.is_file() and "timestamp" not in file.name
    ]
    fresh.snakemake("dvc_all")
    assert digests(fresh.folder) == digests(finished.folder)
