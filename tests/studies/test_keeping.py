"""A measured table is kept beside its study, with its set, the commit and the day."""

import sys
from datetime import UTC, datetime

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from visuohaptic.base.errors import ReportError, TableError
from visuohaptic.io.checkout import find_commit
from visuohaptic.studies import keeping
from visuohaptic.studies.keeping import (
    Source,
    keep,
    keep_study,
    kept_file,
    kept_files,
    read_figures,
    read_source,
    write_measured,
)

TABLE = pa.table({"accuracy": [0.1, 1 / 3]}).replace_schema_metadata({"table": "accuracies"})
TODAY = datetime.now(UTC).strftime("%Y-%m-%d")


@pytest.fixture
def measured(tmp_path):
    """A table that was measured on set paper."""
    write_measured(TABLE, "paper", tmp_path / "measured.parquet")
    return tmp_path / "measured.parquet"


def test_a_kept_table_has_the_rows_of_the_measured_table_and_a_source(tmp_path, measured):
    keep(measured, "paper", tmp_path)
    path = kept_file(tmp_path, "paper")
    assert pq.read_table(path).equals(TABLE)
    assert pq.read_schema(path).metadata[b"table"] == b"accuracies"
    assert read_source(path) == Source("paper", find_commit(), TODAY)


def test_figures_are_kept_with_a_source_and_are_no_table(tmp_path):
    (tmp_path / "measured.json").write_text('[{"accuracy": 0.5, "object": "Hôi An"}]')
    keep(tmp_path / "measured.json", "odd", tmp_path)
    figures, source = read_figures(tmp_path, "odd")
    assert figures == [{"accuracy": 0.5, "object": "Hôi An"}]
    assert source == Source("odd", find_commit(), TODAY)
    assert kept_files(tmp_path) == {}


def test_a_table_of_another_set_is_refused(tmp_path, measured):
    with pytest.raises(ReportError, match="has set paper; set benchmark is needed"):
        keep(measured, "benchmark", tmp_path)
    assert kept_files(tmp_path) == {}


def test_a_table_that_names_no_set_is_kept_as_the_named_set(tmp_path):
    pq.write_table(TABLE, tmp_path / "answers.parquet")
    keep(tmp_path / "answers.parquet", "odd", tmp_path)
    assert read_source(kept_file(tmp_path, "odd")).set == "odd"


def test_kept_tables_are_found_by_set_and_replace_only_their_own(tmp_path, measured):
    for name in ("paper", "benchmark", "paper"):
        write_measured(TABLE, name, measured)
        keep(measured, name, tmp_path)
    assert list(kept_files(tmp_path)) == ["benchmark", "paper"]


def test_a_file_without_a_source_is_named(tmp_path, measured):
    with pytest.raises(ReportError, match=r"measured\.parquet does not name its commit"):
        read_source(measured)
    with pytest.raises(TableError, match=r"there is no file .*none\.parquet"):
        read_source(tmp_path / "none.parquet")


STUDY = """
from visuohaptic.studies.study import Study
STUDY = Study("keeps_a_table", "A study that keeps a table", kept={!r})
"""


@pytest.fixture
def bring_study(tmp_path, monkeypatch):
    """Return a function that writes a study into a folder of studies with a given entry `kept`."""
    monkeypatch.setattr(keeping, "REPOSITORY", tmp_path)
    monkeypatch.setattr("sys.path", [*sys.path])
    monkeypatch.chdir(tmp_path)

    def write(kept):
        for name in ("keeps_a_table", "keeps_a_table.study"):
            sys.modules.pop(name, None)
        folder = tmp_path / "keeps_a_table"
        folder.mkdir()
        (folder / "__init__.py").touch()
        (folder / "study.py").write_text(STUDY.format(kept))
        return folder

    return write


def test_a_study_names_the_result_that_is_kept(bring_study, measured):
    folder = bring_study(measured.name)
    keep_study("keeps_a_table", "paper")
    assert list(kept_files(folder)) == ["paper"]


def test_of_a_study_that_names_no_result_only_a_named_file_is_kept(bring_study, measured):
    folder = bring_study("")
    with pytest.raises(ReportError, match="Study keeps_a_table has no field `kept`"):
        keep_study("keeps_a_table", "paper")
    keep_study("keeps_a_table", "paper", measured)
    assert list(kept_files(folder)) == ["paper"]
