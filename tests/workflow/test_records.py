"""A record fits where parameters, code and files are those of today, wherever the workflow is used from."""

import json
from dataclasses import dataclass
from types import SimpleNamespace

import pytest

from visuohaptic_workflow.records import is_current, write_record


@dataclass
class Job:
    """A job that keeps a record."""

    params: dict
    code: list
    inputs: list
    outputs: list
    record: str


class Files(list):
    """Files with names, as Snakemake has them."""

    def __init__(self, files, **named):
        super().__init__(files)
        self.__dict__.update(named)


@pytest.fixture
def job(tmp_path, monkeypatch):
    """A job that has run, as a rule of a module."""
    monkeypatch.chdir(tmp_path)
    for name in ("script.py", "in.ply", "out.parquet"):
        (tmp_path / name).write_text(name)
    write_record(
        SimpleNamespace(
            rule="visuohaptic_touches",
            params={"seed": 1},
            input=Files(["in.ply", "script.py"], code=["script.py"]),
            output=Files(["out.parquet", "record.json"], record="record.json"),
        )
    )
    outputs = ["out.parquet", "record.json"]
    return Job({"seed": 1}, ["script.py"], ["in.ply"], outputs, "record.json")


def test_the_name_that_a_module_gives_a_rule_does_not_matter(job):
    assert is_current(job)


def test_a_record_that_names_its_rule_as_older_ones_do_fits(job, tmp_path):
    file = tmp_path / job.record
    file.write_text(json.dumps({**json.loads(file.read_text()), "rule": "touches"}))
    assert is_current(job)


@pytest.mark.parametrize("edited", ["in.ply", "out.parquet", "script.py"])
def test_an_edited_file_does_not_fit(job, tmp_path, edited):
    (tmp_path / edited).write_text("something else")
    assert not is_current(job)


def test_another_parameter_does_not_fit(job):
    job.params = {"seed": 2}
    assert not is_current(job)
