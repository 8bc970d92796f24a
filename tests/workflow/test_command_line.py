"""Snakemake's own options do what they say, from any folder and for any user; the scripts are stand-ins."""

import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from visuohaptic_workflow.jobs import set_job_environment
from visuohaptic_workflow.one_run import FolderError, check_writable, claim_folder
from visuohaptic_workflow.planning import values_of_option

ROOT = Path(__file__).parents[2]

process = pytest.mark.workflow


@process
def test_the_workflow_runs_in_another_folder_with_that_folders_parameters(fresh_stand_in, tmp_path):
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    shutil.copy(fresh_stand_in.folder / "params.yaml", folder)
    elsewhere = replace(fresh_stand_in, folder=folder, clone=fresh_stand_in.folder)
    elsewhere.set(recognition={"classifier": {"neighbours": 3}})
    snakefile = ("-s", str(fresh_stand_in.folder / "Snakefile"))
    output = elsewhere.snakemake(*snakefile).stdout
    assert re.search(r"^\[1 of \d+\] preparing ", output, re.MULTILINE)
    assert (folder / "reports/report.html").exists()
    assert not (fresh_stand_in.folder / "results").exists()
    record = (folder / "results/records/recognition/paper.json").read_text()
    assert '"neighbours": 3' in record
    said = "Nothing to be done; the report is at reports/report.html.\n"
    assert elsewhere.snakemake(*snakefile).stdout.endswith(said)


@process
@pytest.mark.parametrize(
    ("options", "most"), [((), sys.maxsize), (("--max-jobs-per-timespan", "900/1s"), 900)]
)
def test_snakemake_has_no_limit_of_jobs_per_second_whose_timers_add_up_unless_a_user_sets_one(
    stand_in, options, most
):
    stand_in.set(seed=8)
    output = stand_in.snakemake("--verbose", *options).stdout
    limits = {int(count) for count in re.findall(r"'_job_count': (\d+)", output)}
    assert max(limits - {sys.maxsize}, default=sys.maxsize) == most


@process
@pytest.mark.long
def test_a_clone_and_its_python_may_lie_in_a_folder_with_a_blank(whole_stand_in, tmp_path):
    experiment = whole_stand_in.copy(tmp_path / "it's My Projects/experiment")
    (experiment.folder / ".venv").symlink_to(sys.prefix)
    python = str(experiment.folder / ".venv/bin/python")
    (experiment.folder / "reports/metrics.json").unlink()
    experiment.run(python, "-m", "snakemake", "-j1", "--", "reports/metrics.json")
    assert experiment.planned() == {}


@pytest.mark.parametrize(
    ("name", "reason"), [("a{b}", "a brace in its path"), ("a:b", "a colon in its path")]
)
def test_a_path_that_can_not_be_used_is_refused_before_packages_are_downloaded(
    tmp_path, name, reason
):
    (tmp_path / name).mkdir()
    script = shutil.copy(ROOT / "set_up.sh", tmp_path / name)
    ended = subprocess.run([script, "packages"], check=False, capture_output=True, text=True)
    assert ended.returncode == 1
    assert ended.stderr.startswith(f"{tmp_path / name} has {reason}, ")
    assert not (tmp_path / name / ".venv").exists()


def test_a_folder_that_this_user_may_not_write_is_named(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / ".cache/run.lock").mkdir(parents=True)
    with pytest.raises(FolderError, match=f"{tmp_path} can't be written .* `make why` lists"):
        claim_folder()
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(FolderError, match=r"can't be written \(permission denied\)"):
        check_writable()


def test_the_callers_python_path_is_kept(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", "/brought/by/a/module")
    set_job_environment(Path("src"))
    assert os.environ["PYTHONPATH"].split(os.pathsep)[-1] == "/brought/by/a/module"


@process
@pytest.mark.parametrize(
    ("sensor", "options", "sentence"),
    [
        ({"largest_size": -1, "shape": "round"}, [], "sensor.shape is no parameter"),
        (
            {"shape": "round"},
            ["--config", "seed=3"],
            "error: params.yaml: sensor.shape is no parameter",
        ),
        ({}, ["--config", "nosuch=1"], "error: --config: nosuch is no parameter."),
        ({}, ["-Cseed=yes"], "error: --config: seed (line 1) is yes"),
        (
            {},
            ["--config", "workflow={studies: [palm]}"],
            "error: workflow.studies: 'palm' is no study;",
        ),
        ({}, ["--rerun-triggers", "params"], "--rerun-triggers allows only mtime"),
    ],
)
def test_what_can_not_be_planned_is_one_sentence(fresh_stand_in, sensor, options, sentence):
    fresh_stand_in.set(sensor=sensor)
    result = fresh_stand_in.snakemake("-n", *options, "--", "all", check=False)
    assert result.returncode == 1
    assert sentence in result.stdout
    assert "Traceback" not in result.stdout


@process
def test_unusable_files_are_warned_of_once_and_not_by_the_process_that_writes_dvcs_lock(stand_in):
    for number in range(6):
        (stand_in.folder / f"meshes/own/cup{number}.xyz").touch()
    (stand_in.folder / "studies").mkdir(exist_ok=True)
    (stand_in.folder / "studies/broken.yaml").write_text("title: {")
    asked = ("snakemake", "--list-rules", "--quiet", "--workflow-profile", "none")
    warning = "warning: 6 files can't be used: "
    said = stand_in.run(*asked, VISUOHAPTIC_ASKED="why").stdout
    assert said.count("warning: ") == 2
    assert warning in said
    assert "Study broken is left out." in said
    refused = stand_in.snakemake("-n", "--", "study_broken", check=False)
    assert "studies/broken.yaml can't be read" in refused.stdout
    assert refused.returncode == 1
    # Without Git the lock can't be written.
    locked = stand_in.run(*asked, check=False, VISUOHAPTIC_ASKED="lock").stdout
    assert "dvc.lock stays as it was" in locked
    assert "warning: " not in locked


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
