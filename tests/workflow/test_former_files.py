"""Files of former jobs are found by their records and names, in the folders that a run covers; files of users stay."""

import json
from pathlib import Path

import pytest

from visuohaptic_workflow.code_of_jobs import Runs
from visuohaptic_workflow.former_files import find_former_files, move_aside
from visuohaptic_workflow.keys import Job

CONSTRAINTS = {"objects": "[^/]+/[^/]+", "views": r"\d+-\d+"}
TOUCHES = "results/touches/{objects}/{views}.parquet"
RECORD = "results/records/touches/{objects}/{views}.json"


def write(*names, tables=None, log="logs/a.log"):
    for name in names:
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        content = {"key": "", "parts": {}, "tables": tables or {}, "log": log}
        Path(name).write_text(json.dumps(content))


def job(rule, *tables):
    record = f"results/records/{rule}.json"
    outputs = (*tables, record)
    return {record: Job(rule, {}, Runs(Path("a.py"), ()), (), outputs, record, dict)}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def former(jobs, *patterns):
    return find_former_files(jobs, jobs, patterns, CONSTRAINTS)


def test_a_file_that_fits_a_pattern_is_former_without_a_record_and_a_file_of_the_user_stays():
    today, gone = (f"results/touches/cup/a/{views}.parquet" for views in ("00-15", "16-31"))
    mine = (
        "results/touches/mine.parquet",
        "results/touches/mine/a.parquet",
        "results/touches/cup/a/x.parquet",
    )
    write(today, gone, *mine)
    assert former(job("touches", today), TOUCHES, RECORD) == [gone]


def test_a_block_of_meshes_is_a_folder():
    write("results/meshes/cup/a/cup/a.ply", "results/meshes/cup/b/cup/b.ply")
    jobs = job("meshes", "results/meshes/cup/a")
    assert former(jobs, "results/meshes/{objects}") == ["results/meshes/cup/b"]


def test_tables_record_and_log_of_a_record_of_no_job_are_former_where_the_run_covers_their_folder():
    write(
        "results/touches/now.parquet",
        "results/touches/gone.parquet",
        "results/scores/gone.parquet",
        "logs/gone.log",
    )
    write(
        "results/records/gone.json",
        tables={"results/touches/gone.parquet": ""},
        log="logs/gone.log",
    )
    write("results/records/scores.json", tables={"results/scores/gone.parquet": ""})
    found = former(job("touches", "results/touches/now.parquet"))
    assert found == ["results/records/gone.json", "results/touches/gone.parquet", "logs/gone.log"]


def test_a_log_that_a_record_of_today_names_stays():
    write("results/records/touches.json", log="logs/touches.log")
    write(
        "results/records/gone.json",
        tables={"results/touches/a.parquet": ""},
        log="logs/touches.log",
    )
    write("results/touches/a.parquet", "logs/touches.log")
    jobs = job("touches", "results/touches/now.parquet")
    assert former(jobs) == ["results/records/gone.json", "results/touches/a.parquet"]


def test_files_are_moved_with_their_paths_and_empty_folders_go():
    write("results/touches/cup/a/16-31.parquet", "results/touches/bed/b/00-15.parquet")
    target = Path(
        move_aside(["results/touches/cup/a/16-31.parquet", "results/touches/gone.parquet"])
    )
    assert (target / "results/touches/cup/a/16-31.parquet").is_file()
    assert not Path("results/touches/cup").exists()
    assert Path("results/touches/bed/b/00-15.parquet").is_file()
