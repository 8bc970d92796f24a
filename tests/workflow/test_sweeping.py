"""A sweep leaves only current files: stale files go to the store, files of today's keys come back, others are put aside."""

import json
import os
import shutil
import time
from pathlib import Path

import pytest

from visuohaptic.base.errors import StorageError
from visuohaptic_workflow.code_of_jobs import Code, Runs
from visuohaptic_workflow.digests import Digests
from visuohaptic_workflow.keys import Job, Keys, read_record
from visuohaptic_workflow.sweeping import (
    MODEL_RECORDS,
    RECORDS,
    carry_out,
    find_former,
    folder_of,
    is_at_hand,
    is_stored,
    plan_sweep,
    prune,
)

CONSTRAINTS = {"objects": "[^/]+/[^/]+", "views": r"\d+-\d+"}
TOUCHES = "results/touches/{objects}/{views}.parquet"
RECORD = "results/records/touches/{objects}/{views}.json"
GIGABYTE = 1e9


class Folder:
    """A working folder whose jobs touch blocks of objects; a table holds the size of the sensor."""

    def __init__(self):
        self.size = 0.3
        self.blocks = ["cup/a"]

    def keys(self):
        jobs = [
            Job(
                "touches", {}, Runs(Path("touch.py"), ()),
                (f"results/touches/{block}/00-15.parquet", f"results/meshes/{block}", record),
                record, tuple, lambda: {"size": self.size},
            )
            for block in self.blocks
            for record in [f"results/records/touches/{block}/00-15.json"]
        ]  # fmt: skip
        return Keys(jobs, lambda _: Code((), {}), Digests(), Path.cwd(), find_former)

    def sweep(self, records=RECORDS):
        return plan_sweep(
            self.keys(), records, (TOUCHES, RECORD, "results/meshes/{objects}"), CONSTRAINTS
        )

    def run(self, most_bytes=GIGABYTE):
        """Sweep, make what is stale, and return the records of the jobs that ran."""
        sweep = self.sweep()
        carry_out(sweep, most_bytes)
        keys = self.keys()
        for record in sweep.stale:
            table, meshes = keys.jobs[record].tables
            write(table, str(self.size))
            write(f"{meshes}/a.ply", "mesh")
            log = record.replace("results/records", "logs")
            write(log, f"size {self.size}")
            tables = {file: Digests().of(file) for file in (table, meshes)}
            content = {"key": keys.key(record), "parts": keys.parts(record), "tables": tables}
            write(record, json.dumps({**content, "log": log}))
        assert not self.sweep().stale
        assert not self.sweep().moved
        return [*sweep.stale]


def write(name, text):
    Path(name).parent.mkdir(parents=True, exist_ok=True)
    Path(name).write_text(text)


def names(folder="results"):
    return sorted(str(file) for file in Path(folder).rglob("*") if file.is_file())


A = "results/touches/cup/a/00-15.parquet"
OF_A = "results/records/touches/cup/a/00-15.json"
LOG_OF_A = "logs/touches/cup/a/00-15.json"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = Folder()
    assert folder.run() == [OF_A]
    return folder


def test_a_way_back_makes_nothing_and_brings_tables_folders_records_and_logs(folder):
    before = {name: Path(name).read_text() for name in (*names(), *names("logs"))}
    key = read_record(OF_A)["key"]
    folder.size = 0.2
    assert folder.run() == [OF_A]
    assert Path(A).read_text() == "0.2"
    assert Path(LOG_OF_A).read_text() == "size 0.2"
    assert (folder_of(OF_A, key) / A).read_text() == "0.3"
    folder.size = 0.3
    assert folder.run() == []
    assert {name: Path(name).read_text() for name in (*names(), *names("logs"))} == before
    assert not folder_of(OF_A, key).exists()


def test_a_plan_moves_nothing_and_names_what_differs_also_after_the_move(folder):
    folder.size = 0.2
    before = names(".")
    sweep = folder.sweep()
    assert sweep.stale == {OF_A: "parameters: size"}
    assert names(".") == before
    carry_out(sweep, GIGABYTE)
    assert not names()
    assert folder.sweep().stale == {OF_A: "parameters: size"}


@pytest.mark.parametrize("damage", ["edit", "cut", "no record", "no record for it", "no table"])
def test_files_that_fit_no_record_are_put_aside_and_not_into_the_store(folder, damage):
    if damage == "no table":
        Path(A).unlink()
    elif damage == "no record":
        Path(OF_A).unlink()
    elif damage == "no record for it":
        Path(OF_A).write_text("{}")
    else:
        Path(A).write_text("edited" if damage == "edit" else "0")
    left = [Path(name).read_text() for name in names()]
    assert folder.run() == [OF_A]
    assert not Path(".cache/tables").exists()
    moved = [file for file in names(".cache/aside") if "/logs/" not in file]
    assert [Path(name).read_text() for name in moved] == left


@pytest.mark.parametrize("damage", ["edit", "lose", "swap the key"])
def test_a_damaged_file_of_the_store_does_not_come_back(folder, damage):
    key = read_record(OF_A)["key"]
    folder.size = 0.2
    folder.run()
    stored = folder_of(OF_A, key)
    if damage == "swap the key":
        stored.rename(stored.with_name("0" * 64))
    elif damage == "edit":
        (stored / A).write_text("edited")
    else:
        (stored / A).unlink()
    folder.size = 0.3
    assert folder.run() == [OF_A]
    assert Path(A).read_text() == "0.3"


def test_blocks_of_no_job_go_to_the_store_and_files_of_the_user_stay(folder):
    mine = (
        "results/touches/mine.parquet",
        "results/touches/mine/a.parquet",
        "results/touches/cup/a/x.parquet",
    )
    for file in mine:
        write(file, "mine")
    # Without a record, its name tells.
    write("results/touches/cup/c/00-15.parquet", "c")
    folder.blocks = ["cup/b"]
    assert folder.run() == ["results/records/touches/cup/b/00-15.json"]
    assert [name for name in names("results/touches") if "cup/b" not in name] == sorted(mine)
    assert is_stored("results/records/touches/cup/*/00-15.json")
    assert not is_stored("results/records/touches/bed/*/00-15.json")
    (aside,) = Path(".cache/aside").rglob("*.parquet")
    assert aside.read_text() == "c"


def test_a_former_job_does_not_take_the_files_of_a_current_job(folder):
    content = json.loads(Path(OF_A).read_text())
    write("results/records/former.json", json.dumps({**content, "key": "1" * 64}))
    assert folder.run() == []
    assert Path(A).read_text() == "0.3"
    assert Path(LOG_OF_A).exists()
    assert not Path("results/records/former.json").exists()


@pytest.mark.parametrize(
    "path",
    [
        "../outside.json", "{root}/outside.json", "src/code.json", "results/../src/code.json",
        "results/mine.txt", "results//mine.json", "results/mine/./a.json",
    ],
)  # fmt: skip
@pytest.mark.parametrize("fits", [True, False])
def test_a_record_from_elsewhere_moves_no_other_files(folder, path, fits):
    path = path.format(root=Path.cwd().parent)
    write(path, "mine")
    digest = Digests().of(path) if fits else ""
    content = {"key": "1" * 64, "parts": {}, "tables": {path: digest}, "log": path}
    write("results/records/foreign.json", json.dumps(content))
    folder.run()
    assert Path(path).read_text() == "mine"


@pytest.mark.parametrize(
    "name", ["results", "results/", "results/touches", "results/records", "results/touches/cup/a"]
)
def test_a_record_that_names_a_folder_moves_no_folder(folder, name):
    write("results/touches/notes.txt", "mine")
    content = {"key": "1" * 64, "parts": {}, "tables": {name: ""}, "log": name}
    write("results/records/foreign.json", json.dumps(content))
    assert folder.run() == []
    assert Path("results/touches/notes.txt").read_text() == "mine"


@pytest.mark.parametrize("table", ["/dev/zero", "results/a\0b.json", "results/\ud800.json"])
def test_a_record_that_names_what_is_no_file_is_put_aside(folder, table):
    content = {"key": "1" * 64, "parts": {}, "tables": {table: "x"}, "log": "logs/a.log"}
    write("results/records/foreign.json", json.dumps(content))
    assert folder.run() == []
    assert list(Path(".cache/aside").rglob("foreign.json"))


def test_a_pipe_in_the_place_of_a_table_is_put_aside_unread(folder):
    Path(A).unlink()
    os.mkfifo(A)
    assert folder.run() == [OF_A]
    assert Path(A).read_text() == "0.3"


def test_a_key_that_is_a_path_leaves_no_folder(folder):
    write("results/records/foreign.json", json.dumps(
        {"key": "../../../../outside", "parts": {}, "tables": {}, "log": ""}
    ))  # fmt: skip
    folder.run()
    assert not Path("outside").exists()
    assert list(Path(".cache/aside").rglob("foreign.json"))


def test_files_are_at_hand_if_they_are_current_or_wait_in_the_store(folder):
    assert is_at_hand(folder.keys(), OF_A)
    folder.size = 0.2
    assert not is_at_hand(folder.keys(), OF_A)
    folder.run()
    folder.size = 0.3
    assert is_at_hand(folder.keys(), OF_A)
    (stored,) = Path(".cache/tables").rglob("00-15.parquet")
    stored.write_text("edited")
    assert not is_at_hand(folder.keys(), OF_A)


def test_models_are_swept_only_for_their_own_records(folder):
    folder.size = 0.2
    assert folder.sweep(MODEL_RECORDS).stale == {}
    assert not folder.sweep(MODEL_RECORDS).stored


def test_files_that_come_back_have_the_present_time(folder):
    made = (A, "results/meshes/cup/a", OF_A)
    for file in made:
        os.utime(file, (1e9, 1e9))
    folder.size = 0.2
    folder.run()
    folder.size = 0.3
    assert carry_out(folder.sweep(), GIGABYTE) == []
    assert all(1e9 < Path(file).stat().st_mtime < time.time() + 1 for file in made)


def test_files_that_come_back_from_the_future_are_named(folder, monkeypatch):
    os.utime(A, (4e9, 4e9))
    folder.size = 0.2
    folder.run()
    folder.size = 0.3
    set_time = os.utime

    def refuse(path, *more):
        if not more:
            raise PermissionError(1, "Operation not permitted", str(path))
        set_time(path, *more)

    monkeypatch.setattr(os, "utime", refuse)
    assert carry_out(folder.sweep(), GIGABYTE) == [A]
    assert Path(A).stat().st_mtime <= time.time()


@pytest.mark.parametrize("place", [".cache", ".cache/tables", ".cache/tables/records/touches"])
def test_a_store_that_is_no_folder_is_one_sentence_and_all_files_stay(folder, place):
    write(place, "no folder")
    folder.size = 0.2
    before = {name: Path(name).read_text() for name in names(".")}
    with pytest.raises(StorageError, match=rf"^{A} can't be moved to \.cache/tables/"):
        carry_out(folder.sweep(), GIGABYTE)
    assert {name: Path(name).read_text() for name in names(".")} == before


def test_the_oldest_folders_of_the_store_are_removed_beyond_its_size(folder):
    for count, size in enumerate((0.4, 0.5, 0.6)):
        folder.size = size
        folder.run()
        for stored in Path(".cache/tables/records/touches/cup/a/00-15").iterdir():
            if time.time() - stored.stat().st_mtime < 1000:
                os.utime(stored, (1e9 + count, 1e9 + count))

    def values():
        return sorted(path.read_text() for path in Path(".cache/tables").rglob("*.parquet"))

    assert values() == ["0.3", "0.4", "0.5"]
    total = sum(Path(name).stat().st_size for name in names(".cache/tables"))
    prune(total - 1)
    assert values() == ["0.4", "0.5"]
    prune(0)
    assert values() == []
    assert Path(A).read_text() == "0.6"


@pytest.mark.parametrize("number", range(1, 9))
def test_a_sweep_that_ends_at_any_move_loses_no_file_and_the_next_run_makes_right_tables(
    folder, monkeypatch, number
):
    folder.size = 0.2
    folder.run()
    folder.size = 0.3
    sweep = folder.sweep()
    move, moves = shutil.move, []

    def end_at_a_move(source, target):
        moves.append(source)
        if len(moves) == number:
            raise OSError(28, "No space left on device", str(target))
        move(source, target)

    before = sorted(Path(name).read_text() for name in names("."))
    with monkeypatch.context() as patch:
        patch.setattr(shutil, "move", end_at_a_move)
        with pytest.raises(StorageError, match="No space left on device"):
            carry_out(sweep, GIGABYTE)
    assert sorted(Path(name).read_text() for name in names(".")) == before
    folder.run()
    assert Path(A).read_text() == "0.3"
