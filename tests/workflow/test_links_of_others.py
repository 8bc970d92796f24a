"""Links into a cache whose files are another user's are judged without setting those files' times."""

import os
from pathlib import Path
from types import SimpleNamespace

import pytest
from workflow.test_plan import Named

from visuohaptic_workflow.brought_files import judge_brought_files
from visuohaptic_workflow.plan import plan_jobs
from visuohaptic_workflow.records import write_record

TABLE, RECORD, SCRIPT = "results/table.parquet", "results/record.json", "script.py"


@pytest.fixture(params=["hardlink", "symlink"])
def brought(request, tmp_path, monkeypatch):
    """The job of a table that is a link to another user's file."""
    monkeypatch.chdir(tmp_path)
    Path("results").mkdir()
    Path("cached.parquet").write_text("table")
    link = os.link if request.param == "hardlink" else os.symlink
    link(tmp_path / "cached.parquet", TABLE)
    Path(SCRIPT).write_text("script")
    output = Named(table=TABLE, record=RECORD)
    asked = SimpleNamespace(params={"seed": 1}, input=Named(code=SCRIPT), output=output)
    asked.input.code = [SCRIPT]
    write_record(asked)
    theirs = Path("cached.parquet").stat().st_ino
    set_times = os.utime

    def utime(path, *times, follow_symlinks=True, **more):
        if os.stat(path, follow_symlinks=follow_symlinks).st_ino == theirs:  # noqa: PTH116
            raise PermissionError(1, "Operation not permitted", str(path))
        set_times(path, *times, follow_symlinks=follow_symlinks, **more)

    monkeypatch.setattr(os, "utime", utime)
    rule = SimpleNamespace(input=asked.input, output=output, log=[], params=Named(seed=1))
    return plan_jobs({"tables": rule}, {}, {})[0]


def test_a_current_file_becomes_a_copy_that_is_newer_than_the_code(brought, tmp_path):
    assert judge_brought_files([brought]) == []
    assert not Path(TABLE).is_symlink()
    assert Path(TABLE).stat().st_nlink == 1
    assert Path(TABLE).read_text() == "table"
    assert Path(TABLE).stat().st_mtime >= Path(SCRIPT).stat().st_mtime
    assert sorted(file.name for file in (tmp_path / "results").iterdir()) == [
        "record.json",
        "table.parquet",
    ]


def test_an_outdated_link_goes_and_the_other_users_file_stays(brought):
    Path(SCRIPT).write_text("edited")
    assert judge_brought_files([brought]) == [brought]
    assert not os.path.lexists(TABLE)
    assert Path("cached.parquet").read_text() == "table"
