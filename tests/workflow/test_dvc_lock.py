"""DVC's lock is written for a finished run, and for nothing else; `dvc.yaml` names all that a run takes and makes."""

import json
import subprocess
from pathlib import Path

import pytest
import yaml
from workflow.stand_ins import digests

from visuohaptic.parameters import ExperimentParameters
from visuohaptic_workflow import dvc_lock
from visuohaptic_workflow.dvc_lock import LockError, check_clone, is_committed
from visuohaptic_workflow.jobs import without_studies_of_clones
from visuohaptic_workflow.sweeping import Sweep

ROOT = Path(__file__).parents[2]
STAGE = yaml.safe_load((ROOT / "dvc.yaml").read_text())["stages"]["experiment"]
OUTPUTS = [name for part in ("outs", "metrics", "plots") for entry in STAGE[part] for name in entry]
OTHER_SIZE = ("--config", 'sensor={"largest_size": 0.2}')
KEPT = "dvc.lock stays as it was"


def is_below(name, folders):
    return any(Path(name).is_relative_to(folder) for folder in folders)


def test_the_stage_takes_every_section_of_parameters():
    assert set(STAGE["params"]) == set(ExperimentParameters.model_fields)


def test_every_output_persists():
    entries = [entry for part in ("outs", "metrics", "plots") for entry in STAGE[part]]
    assert all(options == {"persist": True} for entry in entries for options in entry.values())


@pytest.mark.workflow
def test_the_stage_names_what_a_run_takes_and_makes_and_all_of_it_exists(whole_stand_in):
    folder = whole_stand_in.folder
    assert [name for name in digests(folder) if not is_below(name, OUTPUTS)] == []
    assert [name for name in OUTPUTS if not (folder / name).exists()] == []
    for record in (folder / "results").rglob("*records/**/*.json"):
        parts = json.loads(record.read_text())["parts"]
        named = [name for name in (*parts["code"], *parts["sources"]) if ".." not in name]
        assert [name for name in named if not is_below(name, STAGE["deps"])] == []


@pytest.fixture
def locked(repository, tmp_path):
    """A repository whose lock was written by a run, and the lock's text."""
    experiment = repository.copy(tmp_path / "experiment")
    (experiment.folder / "dvc.lock").unlink()
    (experiment.folder / "results/records/report.json").unlink()
    experiment.snakemake()
    return experiment, (experiment.folder / "dvc.lock").read_text()


def lock_of(experiment):
    return (experiment.folder / "dvc.lock").read_text()


@pytest.mark.workflow
@pytest.mark.slow
def test_after_a_run_an_experiment_with_the_same_values_starts_no_job_and_warns_of_nothing(locked):
    experiment, _ = locked
    output = experiment.run("dvc", "exp", "run").stdout
    assert "didn't change" in output
    assert "WARNING" not in output
    assert "Running stage" not in output
    assert "up to date" in experiment.run("dvc", "status").stdout


@pytest.mark.workflow
@pytest.mark.long
def test_other_parameters_and_parts_of_a_run_leave_the_lock_as_it_was(locked):
    experiment, before = locked
    said = experiment.snakemake(*OTHER_SIZE).stdout
    assert f"{KEPT}: this run's parameters are not those of params.yaml." in said
    assert lock_of(experiment) == before
    values = experiment.folder / "other.yaml"
    values.write_text("sensor: {largest_size: 0.15}\n")
    assert KEPT in experiment.snakemake("--configfile", "other.yaml").stdout
    experiment.set(sensor={"largest_size": 0.25})
    for arguments in (["touches_all"], ["--until", "features"], ["--touch"]):
        experiment.snakemake(*arguments, check="--touch" not in arguments)
        assert lock_of(experiment) == before
    experiment.snakemake()
    assert "largest_size: 0.25" in lock_of(experiment)
    assert "didn't change" in experiment.run("dvc", "repro").stdout


@pytest.mark.workflow
@pytest.mark.long
def test_a_source_edited_in_the_last_job_leaves_the_lock_as_it_was(locked):
    experiment, before = locked
    script = experiment.folder / "workflow/scripts/report.py"
    script.write_text(
        f"{script.read_text()}\nwith open('meshes/paper/chair/bsby_chair3.ply.gz', 'ab') as file:\n    file.write(b' ')\n"
    )
    output = experiment.snakemake().stdout
    assert f"{KEPT}: " in output
    assert "do not match the current parameters, code and meshes" in output
    assert lock_of(experiment) == before


@pytest.mark.workflow
@pytest.mark.long
def test_a_commit_that_fails_ends_in_a_sentence_and_the_next_one_locks(locked):
    experiment, before = locked
    experiment.set(sensor={"largest_size": 0.25})
    cache = experiment.folder / ".dvc/cache"
    cache.rename(cache.with_name("aside"))
    cache.write_text("no folder")
    output = experiment.snakemake().stdout
    assert f"{KEPT}: `dvc commit` ended with: " in output
    assert "Traceback" not in output
    assert lock_of(experiment) == before
    cache.unlink()
    cache.with_name("aside").rename(cache)
    ask = ("snakemake", "--list-rules", "--quiet", "--workflow-profile", "none")
    experiment.run(*ask, VISUOHAPTIC_ASKED="lock")
    assert "largest_size: 0.25" in lock_of(experiment)


NOTHING = Sweep(stored={}, aside=(), returned={}, stale={})


class Keys:
    """Keys of one job, which fits; `unchanged` says whether it still does after the commit."""

    def __init__(self, *, unchanged):
        self.unchanged = unchanged

    def needed_for(self, targets):
        return ["record"]

    def is_unchanged(self, record):
        return self.unchanged


@pytest.mark.parametrize(
    "content", ["schema: '2.0'\nstages:\n  experiment:\n    cmd: a\n    dep", ""]
)
def test_a_lock_that_was_cut_off_is_written_anew(tmp_path, monkeypatch, content):
    monkeypatch.chdir(tmp_path)
    Path("dvc.lock").write_text(content)

    def commit(*_, **__):
        assert not Path("dvc.lock").exists()
        Path("dvc.lock").write_text("schema: '2.0'")
        return subprocess.CompletedProcess([], 0, "", "")

    monkeypatch.setattr(dvc_lock.subprocess, "run", commit)
    dvc_lock.write_lock(Keys(unchanged=True), ["all"], lambda: True, NOTHING)
    assert Path("dvc.lock").read_text() == "schema: '2.0'"


@pytest.mark.parametrize(
    ("are_files_unchanged", "are_parameters_current"), [(False, True), (True, False)]
)
def test_a_lock_is_put_back_if_a_file_changes_while_dvc_reads(
    tmp_path, monkeypatch, are_files_unchanged, are_parameters_current
):
    monkeypatch.chdir(tmp_path)
    Path("dvc.lock").write_text("written: before")

    def commit(*_, **__):
        Path("dvc.lock").write_text("after")
        return subprocess.CompletedProcess([], 0, "", "")

    monkeypatch.setattr(dvc_lock.subprocess, "run", commit)
    keys = Keys(unchanged=are_files_unchanged)
    with pytest.raises(LockError, match="a file changed while DVC read the results"):
        dvc_lock.write_lock(keys, ["all"], lambda: are_parameters_current, NOTHING)
    assert Path("dvc.lock").read_text() == "written: before"
    dvc_lock.write_lock(Keys(unchanged=True), ["all"], lambda: True, NOTHING)
    assert Path("dvc.lock").read_text() == "after"


def test_an_experiment_elsewhere_is_refused_in_a_shallow_clone(tmp_path, monkeypatch):
    origin, clone = tmp_path / "origin", tmp_path / "clone"
    author = ["-c", "user.name=A", "-c", "user.email=a@b.c"]
    subprocess.run(["git", "init", "-q", origin], check=True)
    for message in ("one", "two"):
        commit = ["commit", "-q", "--allow-empty", "-m", message]
        subprocess.run(["git", "-C", origin, *author, *commit], check=True)
    subprocess.run(["git", "clone", "-q", "--depth", "1", f"file://{origin}", clone], check=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("DVC_ROOT", str(origin))
    check_clone()
    monkeypatch.setenv("DVC_ROOT", str(clone))
    with pytest.raises(LockError, match=r"is a shallow clone, .* `git fetch --unshallow`"):
        check_clone()
    monkeypatch.chdir(clone)
    check_clone()


def test_an_experiment_elsewhere_is_refused_if_git_does_not_track_an_own_mesh(
    tmp_path, monkeypatch
):
    clone = tmp_path / "clone"
    subprocess.run(["git", "init", "-q", clone], check=True)
    mesh = clone / "meshes/own/cup/mug.obj"
    mesh.parent.mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("DVC_ROOT", str(clone))
    check_clone()
    mesh.touch()
    with pytest.raises(LockError, match=r"track meshes/own/cup/mug\.obj, .* `git add meshes/own`"):
        check_clone()
    subprocess.run(["git", "-C", clone, "add", "meshes/own"], check=True)
    check_clone()


@pytest.mark.parametrize("status", [0, 1])
def test_whether_the_lock_was_written_is_told_by_its_process(monkeypatch, status):
    ended = subprocess.CompletedProcess([], status)
    monkeypatch.setattr(dvc_lock.subprocess, "run", lambda *_, **__: ended)
    assert dvc_lock.lock_in_new_process({}) == (status == 0)


def test_a_staged_lock_is_not_committed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert not is_committed()
    subprocess.run(["git", "init", "-q"], check=True)
    Path("dvc.lock").touch()
    subprocess.run(["git", "add", "dvc.lock"], check=True)
    assert not is_committed()
    author = ["-c", "user.name=A", "-c", "user.email=a@b.c"]
    subprocess.run(["git", *author, "commit", "-qm", "Results"], check=True)
    assert is_committed()


def test_studies_of_another_clone_are_dropped_from_a_search_path_and_own_folders_stay(tmp_path):
    (tmp_path / "clone/workflow").mkdir(parents=True)
    (tmp_path / "clone/workflow/Snakefile").touch()
    paths = [str(tmp_path / name) for name in ("clone/studies", "clone/src", "mine/studies")]
    assert without_studies_of_clones(paths) == paths[1:]
