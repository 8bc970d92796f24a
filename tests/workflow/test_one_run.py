"""One run at a time: what was killed is cleared away, what is at work is respected."""

import os
import signal
import time

import pytest
from workflow.stand_ins import digests

pytestmark = [pytest.mark.workflow, pytest.mark.long]


def wait_for(condition, seconds=120):
    limit = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < limit, "nothing came"
        time.sleep(0.02)


def parts(experiment, table):
    return list((experiment.folder / "results" / table).rglob("[!.]*.parquet"))


def half_written(experiment):
    files = (experiment.folder / "results").rglob(".*")
    return [file for file in files if file.is_file() and "timestamp" not in file.name]


def test_the_plain_command_goes_on_after_a_run_was_ended_in_any_way(fresh_stand_in, whole_stand_in):
    for how, end, table in (
        (signal.SIGINT, os.killpg, "views"),
        (signal.SIGKILL, os.killpg, "touches"),
        (signal.SIGTERM, os.kill, "features"),
    ):
        process = fresh_stand_in.start("snakemake", "-j2")
        wait_for(lambda table=table: parts(fresh_stand_in, table))
        end(process.pid, how)
        assert process.wait(timeout=300) != 0
        assert how != signal.SIGINT or not half_written(fresh_stand_in)
    fresh_stand_in.snakemake()
    assert digests(fresh_stand_in.folder) == digests(whole_stand_in.folder)
    assert fresh_stand_in.planned() == {}


@pytest.fixture
def at_work(stand_in):
    """An experiment whose run is in the middle of its jobs."""
    stand_in.run("git", "init", "-q")
    # Of a module also the process that plans the run would wait.
    script = stand_in.folder / "workflow/scripts/features.py"
    waits = "import time\nopen('begun', 'w')\ntime.sleep(60)\n"
    script.write_text(f"{waits}{script.read_text()}")
    process = stand_in.start("snakemake", "-j2")
    wait_for((stand_in.folder / "begun").exists)
    yield stand_in
    os.killpg(process.pid, signal.SIGKILL)
    process.wait(timeout=300)


def test_beside_a_run_a_second_one_is_refused_and_a_dry_run_is_possible(at_work):
    assert "features" in at_work.snakemake("-n").stdout
    for command in (("snakemake", "-j2"), ("dvc", "repro")):
        result = at_work.run(*command, check=False)
        assert result.returncode != 0
        assert "is active" in result.stdout or "is busy" in result.stdout
    assert parts(at_work, "touches")
