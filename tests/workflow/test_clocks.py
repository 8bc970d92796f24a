"""Files of the future get the present time, and other files keep theirs."""

import os
import time

import pytest

from visuohaptic_workflow.clocks import ClockError, date_at_present
from visuohaptic_workflow.digests import TIMESTAMP

FUTURE, PAST = 2_500_000_000, 946_000_000


@pytest.mark.parametrize("name", ["a.parquet", f"meshes/{TIMESTAMP}"])
def test_only_files_of_the_future_are_dated_at_the_present(tmp_path, name):
    past, future = tmp_path / "past.parquet", tmp_path / name
    future.parent.mkdir(exist_ok=True)
    for file, seconds in ((past, PAST), (future, FUTURE)):
        file.write_text("a")
        os.utime(file, (seconds, seconds))
    asked = future.parent if future.name == TIMESTAMP else future
    found = date_at_present([str(past), str(asked), str(tmp_path / "missing")])
    assert str(future) in found
    assert future.stat().st_mtime <= time.time()
    assert past.stat().st_mtime == PAST
    assert future.read_text() == "a"


def test_a_time_that_may_not_be_changed_is_an_error_that_names_the_file(tmp_path, monkeypatch):
    file = tmp_path / "a.obj"
    file.write_text("a")
    os.utime(file, (FUTURE, FUTURE))

    def refuse(*_):
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "utime", refuse)
    with pytest.raises(
        ClockError, match=r"a\.obj was modified in the future, .* \(Operation not permitted\)"
    ):
        date_at_present([str(file)])
