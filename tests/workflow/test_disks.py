"""Disks that are full, read-only, or others than that of the clone: one sentence that names the file and the reason."""

import errno
import os
import shutil
import tempfile
from pathlib import Path
from types import SimpleNamespace

import pytest
from workflow.test_jobs import logged_job

from visuohaptic.base.errors import StorageError
from visuohaptic_workflow.digests import Digests
from visuohaptic_workflow.one_run import FolderError, check_writable
from visuohaptic_workflow.sweeping import Sweep, carry_out

FULL = OSError(errno.ENOSPC, "Error writing bytes to file")
OTHER_DISK = Path("/dev/shm")  # noqa: S108 - a file system of its own on Linux


FORMER = ("results/meshes/old", "results/old.parquet", "results/records/old.json")
TO_STORE = Sweep({Path(".cache/tables/old"): FORMER}, (), {}, {})
TO_ASIDE = Sweep({}, FORMER, {}, {})


@pytest.fixture
def former(tmp_path, monkeypatch):
    """A working folder with files of former jobs, one of them a folder."""
    monkeypatch.chdir(tmp_path)
    for file in (Path(FORMER[0], "a.ply"), *map(Path, FORMER[1:])):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("a")


def raise_if(error):
    if error:
        raise error


def refuse_with(number):
    def refuse(source, target, **_):
        raise OSError(number, os.strerror(number), str(source), None, str(target))

    return refuse


@pytest.mark.usefixtures("former")
@pytest.mark.parametrize("sweep", [TO_STORE, TO_ASIDE])
def test_former_files_are_moved_to_another_file_system(monkeypatch, sweep):
    # Path.rename and os.rename can't move there.
    monkeypatch.setattr(os, "rename", refuse_with(errno.EXDEV))
    carry_out(sweep, 1e9)
    assert [path.name for path in Path("results").rglob("*.*")] == []
    moved = sorted(path.name for path in Path(".cache").rglob("*.*"))
    assert moved == ["a.ply", "old.json", "old.parquet"]


@pytest.mark.usefixtures("former")
@pytest.mark.parametrize("sweep", [TO_STORE, TO_ASIDE])
@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EROFS])
def test_a_move_to_a_full_or_read_only_disk_is_one_sentence(monkeypatch, number, sweep):
    monkeypatch.setattr(os, "rename", refuse_with(errno.EXDEV))
    for copy in ("copyfile", "copytree"):
        monkeypatch.setattr(shutil, copy, refuse_with(number))
    with pytest.raises(StorageError, match=f"can't be moved to .*: {os.strerror(number)}\\.$"):
        carry_out(sweep, 1e9)
    assert len(list(Path("results").rglob("*.*"))) == 3


@pytest.mark.workflow
@pytest.mark.long
def test_a_run_ends_well_whose_results_are_on_another_file_system(stand_in):
    if not OTHER_DISK.is_dir() or OTHER_DISK.stat().st_dev == stand_in.folder.stat().st_dev:
        pytest.skip(f"{OTHER_DISK} is no other file system than the folder of this test")
    results = stand_in.folder / "results"
    with tempfile.TemporaryDirectory(dir=OTHER_DISK) as elsewhere:
        shutil.copytree(results, elsewhere, dirs_exist_ok=True)
        shutil.rmtree(results)
        results.symlink_to(elsewhere)
        stand_in.set(workflow={"views_per_job": 1})
        assert " former files to .cache/tables." in stand_in.snakemake().stdout
        assert not [*Path(elsewhere).rglob("00-01.*")]
        assert stand_in.planned() == {}


@pytest.mark.parametrize(
    ("error", "sentence"),
    [
        (FULL, "error: {record} can't be written: No space left on device."),
        (
            OSError(errno.EROFS, "", "a.ply"),
            "error: a.ply can't be written: Read-only file system.",
        ),
        (
            OSError(errno.EIO, "", "a.ply"),
            "error: a.ply can't be read or written: Input/output error.",
        ),
    ],
)
def test_a_job_that_meets_a_full_disk_ends_in_one_sentence(tmp_path, capsys, error, sentence):
    log = tmp_path / "a.log"
    with pytest.raises(SystemExit), logged_job(log):
        raise error
    expected = sentence.format(record=tmp_path / "record.json") + "\n"
    assert capsys.readouterr().err == expected
    assert log.read_text() == expected


@pytest.mark.parametrize("error", [None, FULL])
def test_a_log_on_a_full_disk_is_named(tmp_path, capsys, error):
    # Each write to this device says that no space is left.
    log = tmp_path / "a.log"
    log.symlink_to("/dev/full")
    with pytest.raises(SystemExit) as ended, logged_job(log):
        raise_if(error)
    assert ended.value.code == 1
    said = capsys.readouterr().err
    assert f"{log} can't be written: No space left on device.\n" in said
    assert "Traceback" not in said


@pytest.mark.parametrize(
    ("disk", "may_write", "reason"),
    [
        ({"f_bavail": 200, "f_flag": 0}, True, "less than 1 MB of its disk are free"),
        ({"f_bavail": 10**6, "f_flag": os.ST_RDONLY}, False, "read-only file system"),
        ({"f_bavail": 10**6, "f_flag": 0}, False, "permission denied"),
    ],
)
def test_a_folder_in_which_no_run_can_begin_is_refused_with_the_reason(
    tmp_path, monkeypatch, disk, may_write, reason
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(os, "access", lambda *_: may_write)
    monkeypatch.setattr(
        os, "statvfs", lambda _: SimpleNamespace(f_blocks=10**7, f_frsize=4096, **disk)
    )
    with pytest.raises(FolderError, match=rf"{tmp_path} can't be written \({reason}\)"):
        check_writable()


def test_a_file_system_that_does_not_tell_its_size_is_taken(monkeypatch):
    disk = SimpleNamespace(f_blocks=0, f_frsize=4096, f_bavail=0, f_flag=0)
    monkeypatch.setattr(os, "statvfs", lambda _: disk)
    check_writable()


def test_keys_are_computed_on_a_read_only_disk(tmp_path, monkeypatch):
    def refuse(path, **_):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(path))

    (tmp_path / "a.py").write_text("a = 1\n")
    monkeypatch.setattr(Path, "unlink", refuse)
    assert len(Digests().of(tmp_path / "a.py")) == 64
