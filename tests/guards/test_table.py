"""A guard that failed becomes an error in one sentence."""

import pytest

from visuohaptic.errors import GuardError
from visuohaptic.guards.table import failed_guards, require_guards
from visuohaptic.tables.guards import GUARDS
from visuohaptic.tables.schema import build_table, write_table


def guarded(folder, **rows):
    columns = {"guard": list(rows), "outcome": list(rows.values()), "found": ["So."] * len(rows)}
    write_table(GUARDS, build_table(GUARDS, columns), folder / "guards.parquet")
    return folder / "guards.parquet"


def test_guards_that_held_or_were_not_tested_raise_nothing(tmp_path):
    path = guarded(tmp_path, one="held", other="not tested")
    assert failed_guards(path) == []
    require_guards(path, "report.html")


def test_a_guard_that_failed_ends_in_one_sentence_that_names_it(tmp_path):
    path = guarded(tmp_path, one="held", other="failed")
    assert failed_guards(path) == ["other: failed. So."]
    with pytest.raises(GuardError, match=r"as report.html says, too: other: failed\. So\."):
        require_guards(path, "report.html")
