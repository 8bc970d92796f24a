"""Snakemake's own options do what they say, from any folder and for any user."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from workflow.conftest import Experiment
from workflow.walks import make_experiment

from visuohaptic_workflow.one_run import FolderInUseError, check_writable
from visuohaptic_workflow.planning import values_of_option

pytestmark = pytest.mark.workflow

WAITS_FOR_SEVEN_OTHERS = """
import os
import time
from pathlib import Path

Path(f"started-{os.getpid()}").touch()
limit = time.monotonic() + 120
while len(list(Path().glob("started-*"))) < 8:
    if time.monotonic() > limit:
        raise SystemExit("fewer than eight jobs have started")
    time.sleep(0.05)
"""


@pytest.fixture
def fresh(tmp_path):
    """An experiment before anything has run; its scripts are stand-ins."""
    make_experiment(tmp_path / "experiment")
    return Experiment(tmp_path / "experiment")


@pytest.fixture
def finished(fresh):
    """The same after a whole run."""
    fresh.snakemake()
    return fresh


@pytest.mark.parametrize(
    "option",
    [
        ["-j8"],
        pytest.param(["-c8"], marks=pytest.mark.long),
        pytest.param(["--cores", "8"], marks=pytest.mark.long),
    ],
)
def test_eight_jobs_run_at_a_time(fresh, option):
    fresh.set(workflow={"views_per_job": 1})
    fresh.snakemake("meshes_all")
    script = fresh.folder / "workflow/scripts/phase.py"
    script.write_text(WAITS_FOR_SEVEN_OTHERS + script.read_text())
    fresh.run("snakemake", *option, "--until", "fixations")


def test_the_workflow_runs_in_another_folder_with_that_folders_parameters(fresh, tmp_path):
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    parameters = (fresh.folder / "params.yaml").read_text()
    (folder / "params.yaml").write_text(parameters.replace("neighbours: 5", "neighbours: 3"))
    elsewhere = Experiment(folder)
    elsewhere.snakemake("-s", str(fresh.folder / "Snakefile"))
    assert (folder / "reports/report.html").exists()
    assert not (fresh.folder / "results").exists()
    record = (folder / "results/records/recognition/paper/fixation.json").read_text()
    assert '"neighbours": 3' in record
    assert "Nothing to be done" in elsewhere.snakemake("-s", str(fresh.folder / "Snakefile")).stdout


@pytest.mark.long
def test_the_workflow_runs_in_a_folder_named_by_an_option(fresh, tmp_path):
    fresh.snakemake("-d", str(tmp_path / "elsewhere"))
    assert (tmp_path / "elsewhere/reports/report.html").exists()
    assert not (fresh.folder / "results").exists()


def test_a_folder_that_this_user_may_not_write_is_named(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(
        FolderInUseError, match=r"can't be written \(permission denied\); `make why` says"
    ):
        check_writable()


def test_the_callers_python_path_is_kept(fresh, monkeypatch):
    script = fresh.folder / "workflow/scripts/metrics.py"
    script.write_text(
        "import os\nopen('path', 'w').write(os.environ['PYTHONPATH'])\n" + script.read_text()
    )
    environment = {**os.environ, "PYTHONPATH": "/brought/by/a/module"}
    environment["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{environment['PATH']}"
    subprocess.run(["snakemake", "-j2", "--quiet"], cwd=fresh.folder, env=environment, check=True)
    path = (fresh.folder / "path").read_text().split(os.pathsep)
    assert path[-1] == "/brought/by/a/module"
    assert str(fresh.folder / "src") in path


def test_a_failed_job_ends_with_one_and_its_sentence_is_printed(finished):
    script = finished.folder / "workflow/scripts/metrics.py"
    script.write_text(
        "from visuohaptic.errors import ReportError\n"
        "from visuohaptic_workflow.jobs import job\n"
        "with job(snakemake):\n    raise ReportError('The scores are odd.')\n"
    )
    result = finished.snakemake(check=False)
    assert result.returncode == 1
    assert "error: The scores are odd." in result.stdout
    assert "Traceback" not in result.stdout


def test_a_wrong_parameter_is_named_before_anything_runs(fresh):
    fresh.set(sensor={"largest_size": -1})
    result = fresh.snakemake(check=False)
    assert result.returncode == 1
    assert "sensor.largest_size is -1: input should be greater than 0" in result.stdout
    assert not (fresh.folder / "results").exists()


@pytest.mark.parametrize(
    ("arguments", "asked"),
    [
        (["-n", "--rerun-triggers", "params", "--", "all"], {"params"}),
        (["--rerun-triggers", "mtime", "code", "-j2"], {"mtime", "code"}),
        (["--rerun-triggers=input"], {"input"}),
        (["-j2", "features_all"], set()),
    ],
)
def test_triggers_are_read_however_they_are_written(arguments, asked):
    assert set(values_of_option(arguments, "--rerun-triggers")) == asked


def test_a_lock_that_can_t_be_made_is_one_sentence(fresh):
    (fresh.folder / ".cache/run.lock").mkdir(parents=True)
    result = fresh.snakemake(check=False)
    assert result.returncode == 1
    assert f"{fresh.folder} can't be written" in result.stdout
    assert "Traceback" not in result.stdout


def test_reasons_of_snakemake_that_go_by_other_things_than_keys_are_refused(fresh):
    result = fresh.snakemake("-n", "--rerun-triggers", "params", "--", "all", check=False)
    assert result.returncode == 1
    assert "leave out --rerun-triggers" in result.stdout


def test_a_value_after_config_that_yaml_would_change_is_one_sentence(fresh):
    result = fresh.snakemake("-n", "--config", "meshes={set: no}", "--", "all", check=False)
    assert result.returncode == 1
    assert "meshes.set (line 1) is no, which YAML takes for a truth value" in result.stdout
    assert "Traceback" not in result.stdout
