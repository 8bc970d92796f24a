"""A reader finds the old file or the new one, never a part, however the process ends."""

import pytest

from visuohaptic.base.atomic_files import atomic_file, remove_unfinished, unfinished_folder


def test_the_old_file_stays_where_writing_fails(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(TypeError), atomic_file(tmp_path / "a.txt") as unfinished:
        unfinished.write_text(b"no text")
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [("a.txt", "old")]


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
