"""A reader finds the old file or the new one, never a part, however the process ends."""

import errno
import os
import subprocess
import sys

import pytest

from visuohaptic.base.atomic_files import atomic_file, remove_unfinished, unfinished_folder
from visuohaptic.base.errors import StorageError

TABLE = """
import resource, sys
import pyarrow as pa
from visuohaptic.base.errors import StorageError
from visuohaptic.tables.schema import Column, Schema, write_table

resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
schema = Schema("numbers", (Column("number", pa.int64(), "a number"),), ())
table = pa.table({"number": range(10**5)}, schema=schema.arrow)
try:
    write_table(schema, table, sys.argv[1])
except StorageError as error:
    print(error)
"""


def test_the_old_file_stays_where_writing_fails(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(TypeError), atomic_file(tmp_path / "a.txt") as unfinished:
        unfinished.write_text(b"no text")
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [("a.txt", "old")]


def test_a_file_with_the_longest_name_is_written(tmp_path):
    path = tmp_path / f"{'ä' * 125}.ply"
    with atomic_file(path) as unfinished:
        unfinished.write_text("new")
    assert path.read_text() == "new"
    assert [*tmp_path.iterdir()] == [path]


def test_what_is_being_written_can_be_removed_before_the_process_ends_at_once(tmp_path):
    with atomic_file(tmp_path / "done.txt"):
        pass
    with unfinished_folder(tmp_path) as waiting, atomic_file(tmp_path / "a.txt") as unfinished:
        (waiting / "b.txt").touch()
        remove_unfinished()
        left = [file.name for file in tmp_path.iterdir()]
        waiting.mkdir()
        unfinished.touch()
    assert left == ["done.txt"]


def fail_while_writing(path, number):
    path.write_text("half")
    raise OSError(number, "", str(path))


@pytest.mark.parametrize(
    ("number", "verb"),
    [
        (errno.ENOSPC, "written"),
        (errno.EDQUOT, "written"),
        (errno.EROFS, "written"),
        (errno.EIO, "read or written"),
    ],
)
def test_an_error_of_the_disk_names_the_file_that_is_written(tmp_path, number, verb):
    path = tmp_path / "deep/a.txt"
    sentence = f"^{path} can't be {verb}: {os.strerror(number)}\\.$"
    with pytest.raises(StorageError, match=sentence), atomic_file(path) as unfinished:
        fail_while_writing(unfinished, number)
    assert [*path.parent.iterdir()] == []


def test_an_error_of_the_disk_in_a_hidden_folder_names_the_folder_that_is_seen(tmp_path):
    sentence = f"^{tmp_path} can't be written: No space left on device\\.$"
    with (
        pytest.raises(StorageError, match=sentence),
        unfinished_folder(tmp_path) as hidden,
        atomic_file(hidden / "a.txt"),
    ):
        raise OSError(errno.ENOSPC, "")


def test_other_errors_stay(tmp_path):
    with pytest.raises(IsADirectoryError), atomic_file(tmp_path / "a.txt"):
        (tmp_path / "a.txt").mkdir()


def test_arrows_errors_name_the_table(tmp_path):
    """Arrow names no file."""
    command = [sys.executable, "-c", TABLE, str(tmp_path / "a.parquet")]
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    assert printed == f"{tmp_path / 'a.parquet'} can't be written: File too large.\n"
    assert [*tmp_path.iterdir()] == []
