"""A record fits where code, packages, parameters, sources and tables are what they were, whatever any time says."""

import os
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from visuohaptic_workflow.code_of_jobs import Code, Runs
from visuohaptic_workflow.digests import Digests
from visuohaptic_workflow.keys import NEW, NO_RECORD, Job, Keys, read_record
from visuohaptic_workflow.records import StateError, check_inputs, check_unchanged, write_record

LONG_AGO = (946_000_000, 946_000_000)


class Run:
    """Two jobs: a mesh from a model, a touch from the mesh."""

    def __init__(self):
        self.parameters = {"sensor": {"size": 0.3, "reach": 1}}
        self.versions = {"numpy": "2.0"}
        for name in ("model.obj", "look.py", "touch.py"):
            Path(name).write_text(name)

    def keys(self):
        jobs = [
            self.job("mesh", "look.py", ("model.obj",), ("mesh.ply",), {}),
            self.job("touch", "touch.py", ("mesh.ply",), ("touch.parquet",), self.parameters),
        ]
        find_code = lambda runs: Code((runs.script,), self.versions)  # noqa: E731
        return Keys(jobs, find_code, Digests(), Path.cwd())

    @staticmethod
    def job(rule, script, inputs, tables, parameters):
        record = f"{rule}.json"
        outputs = (*tables, record)
        runs = Runs(Path(script).absolute(), ())
        return Job(rule, {}, runs, outputs, record, lambda: inputs, lambda: parameters)

    def make(self, *rules):
        keys = self.keys()
        for record in [f"{rule}.json" for rule in rules or ("mesh", "touch")]:
            given = keys.snapshot(record)
            check_inputs(given)
            job = keys.jobs[record]
            for table in job.tables:
                Path(table).write_text(str(keys.parts(record)))
            check_unchanged(given)

            output = type("Output", (tuple,), {"record": record})(job.outputs)
            write_record(SimpleNamespace(output=output, log=["a.log"]), given)

    def reasons(self):
        keys = self.keys()
        return [keys.reason_not_current("mesh.json"), keys.reason_not_current("touch.json")]


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run = Run()
    assert run.reasons() == ["new", "new"]
    run.make()
    assert run.reasons() == [None, None]
    return run


def replace_by_older(run):
    Path("b.obj").write_text("of 1999")
    os.utime("b.obj", LONG_AGO)
    Path("b.obj").replace("model.obj")


def edit_and_set_time_back(run):
    before = Path("look.py").stat()
    Path("look.py").write_text("l00k.py")
    os.utime("look.py", ns=(before.st_atime_ns, before.st_mtime_ns))


def forget_times(run, draw=None):
    for file in Path().iterdir():
        os.utime(file, LONG_AGO)


@pytest.mark.parametrize(
    ("change", "mesh", "touch"),
    [
        (forget_times, None, None),
        (replace_by_older, "source: model.obj", "source: model.obj"),
        (edit_and_set_time_back, "code: look.py", "code: look.py"),
        (lambda run: run.versions.update(numpy="2.1"), "packages: numpy", "packages: numpy"),
        # What was made of a table stays: it comes out as it was.
        (lambda run: Path("mesh.ply").write_text("x"), "table: mesh.ply", None),
        (lambda run: Path("mesh.ply").unlink(), "table: mesh.ply", None),
        (lambda run: Path("mesh.json").write_text("{}"), NO_RECORD, None),
    ],
)
def test_what_is_another_is_named_and_times_say_nothing(run, change, mesh, touch):
    change(run)
    assert run.reasons() == [mesh, touch]


def test_a_parameter_with_the_name_of_a_wildcard_counts(run):
    def key(changes, condition="few"):
        (job,) = [job for job in run.keys().jobs.values() if job.rule == "touch"]
        other = replace(
            job, wildcards={"condition": condition}, find_params=lambda: {"condition": changes}
        )
        return Keys([other], lambda runs: Code((), {}), Digests(), Path.cwd()).key("touch.json")

    assert len({key({"touches": 2}), key({"touches": 3}), key({"touches": 2}, "more")}) == 3


def test_a_reader_of_a_lost_table_is_stale(run):
    run.parameters = {"sensor": {"size": 0.2, "reach": 1}}
    Path("look.py").write_text("edited")
    for name in ("mesh.ply", "mesh.json"):
        Path(name).unlink()
    keys = run.keys()
    assert keys.reason_not_current("mesh.json") == NEW
    assert keys.reason_not_current("touch.json") == "parameters: sensor.size"
    run.parameters = {"sensor": {"size": 0.3, "reach": 1}}
    assert run.keys().reason_not_current("touch.json") == "from: mesh"


def test_a_job_whose_files_are_gone_is_compared_with_its_former_record(run):
    former = read_record("touch.json")
    for name in ("touch.parquet", "touch.json"):
        Path(name).unlink()
    keys = run.keys()
    remembering = Keys(
        keys.jobs.values(), keys._find_code, Digests(), Path.cwd(), find_former=lambda _: former
    )
    assert remembering.reason_not_current("touch.json") == NEW  # the key is the same
    run.parameters["sensor"]["size"] = 0.2
    keys = run.keys()
    remembering = Keys(
        keys.jobs.values(), keys._find_code, Digests(), Path.cwd(), find_former=lambda _: former
    )
    assert keys.reason_not_current("touch.json") == NEW
    assert remembering.reason_not_current("touch.json") == "parameters: sensor.size"


@pytest.mark.parametrize(
    "text",
    ["", "[]", "{", '{"key": "a", "parts": {}, "tables": []}',
     '{"key": "a", "parts": {}, "tables": [], "log": "a"}',
     '{"key": "a", "parts": {}, "tables": {}, "log": 1}',
     '{"key": "a", "parts": {"from": [1]}, "tables": {}, "log": "a"}',
     "[" * 200_000],
)  # fmt: skip
def test_a_file_that_is_no_record_has_no_content(tmp_path, text):
    (tmp_path / "a.json").write_text(text)
    assert read_record(tmp_path / "a.json") == {}


def test_a_parameter_is_named(run):
    run.parameters = {"sensor": {"size": 0.2, "reach": 1}}
    assert run.reasons() == [None, "parameters: sensor.size"]


@pytest.mark.parametrize(
    ("kept", "today", "path"),
    [
        ({"models": {"cup/a": None}}, {"models": {"cup/a": None, "cup/b": None}}, "models.cup/b"),
        ({"models": {"cup/a": None, "cup/b": None}}, {"models": {"cup/a": None}}, "models.cup/b"),
        ({"objects": ["cup/a"]}, {"objects": ["cup/a", "cup/b"]}, "objects.cup/b"),
        ({"order": ["a", "b"]}, {"order": ["b", "a"]}, "order"),
        ({"touches": [1, 2]}, {"touches": [1, 3]}, "touches"),
    ],
)
def test_a_name_that_came_or_went_is_part_of_the_reason(run, kept, today, path):
    run.parameters = kept
    run.make()
    run.parameters = today
    assert run.reasons() == [None, f"parameters: {path}"]


def test_code_edited_while_a_job_runs_leaves_no_record(run):
    given = run.keys().snapshot("touch.json")
    Path("touch.py").write_text("edited")
    with pytest.raises(StateError, match=r"touch\.py was changed"):
        check_unchanged(given)
    Path("touch.py").write_text("touch.py")
    with pytest.raises(StateError, match="was written during this run"):
        check_unchanged(given)


def test_a_job_refuses_what_was_made_in_another_state_or_edited(run):
    given = run.keys().snapshot("touch.json")
    Path("mesh.ply").write_text("edited")
    with pytest.raises(StateError, match=r"mesh\.ply differs from its record"):
        check_inputs(given)
    Path("model.obj").write_text("other")
    run.make("mesh")
    with pytest.raises(StateError, match=r"mesh\.json is not of this run"):
        check_inputs(given)


@pytest.mark.parametrize("file", ["look.py", "model.obj", "mesh.ply"])
def test_a_file_that_changes_after_keys_are_fixed_is_seen(run, file):
    keys = run.keys()
    assert keys.is_unchanged("mesh.json")
    Path(file).write_text("edited")
    assert not keys.is_unchanged("mesh.json")


@pytest.mark.parametrize("is_known", [True, False])
def test_bytecode_of_an_edit_in_the_same_second_is_not_taken_for_current(tmp_path, is_known):
    import importlib.util

    module = tmp_path / "module.py"
    digests = Digests()
    module.write_text("VALUE = 1")
    if is_known:
        digests.of(module)
    bytecode = Path(importlib.util.cache_from_source(str(module)))
    bytecode.parent.mkdir(exist_ok=True)
    bytecode.write_bytes(b"of the first edit")
    module.write_text("VALUE = 2")
    digests.of(module)
    assert not bytecode.exists()


def test_a_file_that_may_change_again_without_another_time_is_read_again(tmp_path, monkeypatch):
    now = time.time_ns()
    monkeypatch.setattr("visuohaptic_workflow.digests.stamp_of", lambda found: (1, 1, now, now))
    digests, file = Digests(), tmp_path / "a.obj"
    file.write_text("a")
    before = digests.of(file)
    file.write_text("b")
    assert digests.of(file) != before


def test_what_was_read_from_a_file_is_remembered_until_the_file_changes(tmp_path):
    file, memory, asked = tmp_path / "a.py", tmp_path / "memory.json", []

    def find(path):
        asked.append(path.read_text())
        return [path.read_text()]

    file.write_text("one")
    long_ago = time.time_ns() - 10**10
    os.utime(file, ns=(long_ago, long_ago))
    time.sleep(2.1)  # until the time of change is old enough
    digests = Digests(memory)
    assert digests.read_cached(find, file) == ["one"]
    digests.save()
    assert Digests(memory).read_cached(find, file) == ["one"]
    file.write_text("two")
    assert Digests(memory).read_cached(find, file) == ["two"]
    assert asked == ["one", "two"]


def recompute(run):
    """Run what does not fit, in order."""
    for rule in ("mesh", "touch"):
        if run.keys().reason_not_current(f"{rule}.json"):
            run.make(rule)


def lose(name):
    return lambda run, draw: Path(name).unlink(missing_ok=True)


def write(name):
    return lambda run, draw: Path(name).write_text(draw(("one", "two", "others")))


ACTIONS = (
    lambda run, draw: run.parameters["sensor"].update(size=draw((0.2, 0.3))),
    lambda run, draw: run.versions.update(numpy=draw(("2.0", "2.1"))),
    lambda run, draw: recompute(run),
    forget_times,
    *(write(name) for name in ("model.obj", "look.py", "touch.py", "mesh.ply", "touch.parquet")),
    *(lose(name) for name in ("mesh.ply", "mesh.json", "touch.parquet", "touch.json")),
)


@pytest.mark.parametrize("seed", range(60))
def test_after_anything_in_any_order_the_next_run_gives_the_tables_of_a_clean_one(
    tmp_path, monkeypatch, seed
):
    generator = np.random.default_rng(seed)
    draw = lambda choices: choices[generator.integers(len(choices))]  # noqa: E731
    monkeypatch.chdir(tmp_path)
    walked = Run()
    for _ in range(draw(range(2, 12))):
        draw(ACTIONS)(walked, draw)
    recompute(walked)
    assert walked.reasons() == [None, None]
    tables = {name: Path(name).read_text() for name in ("mesh.ply", "touch.parquet")}
    for name in (*tables, "mesh.json", "touch.json"):
        Path(name).unlink()
    walked.make()
    assert tables == {name: Path(name).read_text() for name in tables}
