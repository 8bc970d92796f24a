"""A folder of `visuohaptic new` runs the workflow of its clone, on own objects only; the scripts are stand-ins."""

import json
import sys
from dataclasses import replace

import pytest
import trimesh

pytestmark = pytest.mark.workflow

COMMAND = "from visuohaptic.cli.main import main; main()"
CLASSES = ("bottle", "Tasse für Tee")


@pytest.fixture(scope="module")
def clone(tmp_path_factory, whole_stand_in):
    """A clone without any model of an object."""
    clone = whole_stand_in.copy(tmp_path_factory.mktemp("own") / "clone")
    for file in (clone.folder / "meshes/paper").glob("*/*"):
        file.unlink()
    return clone


@pytest.fixture
def mine(clone, tmp_path):
    """A new folder for own objects, with the parameters of the stand-ins but for the set."""
    made = replace(clone, folder=tmp_path, variables={"PYTHONPATH": str(clone.folder / "src")})
    made.run(sys.executable, "-c", COMMAND, "new", "my objects", *CLASSES)
    folder = replace(clone, folder=tmp_path / "my objects", clone=clone.folder)
    small = "viewpoints: {count: 2}\nworkflow: {views_per_job: 2, objects_per_job: 2}\n"
    with (folder.folder / "params.yaml").open("a") as stream:
        stream.write(f"{small}recognition: {{pipelines: [paper]}}\n")
    return folder


def add(experiment, *names):
    for name in names:
        trimesh.creation.box().export(experiment.folder / f"meshes/own/{name}")


ENOUGH = [f"{category}/{name}.stl" for category in CLASSES for name in "ab"]


def test_a_new_folder_runs_on_own_objects_only_and_keeps_results_when_they_are_gone(clone, mine):
    add(mine, *ENOUGH, "bottle/a.obj")
    says = (
        "warning: meshes/own/bottle/a.stl is object bottle/a, as meshes/own/bottle/a.obj is already"
    )
    assert says in mine.snakemake().stdout
    report = mine.folder / "reports/report.html"
    before = report.read_bytes()
    records = [*(mine.folder / "results/records/meshes").glob("*/*.json")]
    models = [
        model
        for file in records
        for model in json.loads(file.read_text())["parts"]["parameters"]["models"]
    ]
    assert {model.partition("/")[0] for model in models} == {*CLASSES}
    # Keys decide, as in the clone.
    (mine.folder / "meshes/own" / ENOUGH[1]).touch()
    assert "Nothing to be done" in mine.snakemake("-n").stdout
    text = (mine.folder / "params.yaml").read_text()
    changed = text.replace("[paper]", "[paper], classifier: {neighbours: 3}")
    (mine.folder / "params.yaml").write_text(changed)
    planned = mine.planned()
    assert planned["recognition"] == 1
    assert not {"meshes", "features"} & set(planned)
    for folder in (mine.folder, clone.folder / "meshes"):
        assert not [*folder.rglob("*.ply.gz")]
    for file in (mine.folder / "meshes/own").glob("*/*"):
        file.unlink()
    assert "error: There are no objects" in mine.snakemake(check=False).stdout
    assert report.read_bytes() == before


def test_too_few_objects_end_the_run_before_its_first_job(mine):
    add(mine, "bottle/a.stl", "bottle/b.stl")
    ended = mine.snakemake(check=False)
    assert ended.returncode == 1
    assert "with two objects each, and only bottle has them" in ended.stdout
    assert "Traceback" not in ended.stdout
    assert not (mine.folder / "results").exists()


def test_wrong_parameters_are_named_with_their_file(mine):
    add(mine, *ENOUGH)
    file = mine.folder / "params.yaml"
    text = file.read_text()
    file.write_text(text.replace("set: own", "set: mine"))
    sentence = "error: params.yaml: meshes.set is 'mine': paper, "
    assert sentence in mine.snakemake("-n", check=False).stdout
    file.write_text(text.replace("set: own", "set: own\n  merge_tolerance: 1"))
    sentence = "error: params.yaml: meshes.merge_tolerance is no parameter"
    assert sentence in mine.snakemake("-n", check=False).stdout


def test_a_clone_that_moved_is_named(mine):
    file = mine.folder / "Snakefile"
    file.write_text(file.read_text().replace("/clone/", "/moved/"))
    ended = mine.snakemake("-n", check=False)
    assert ended.returncode == 1
    assert "/moved/workflow/Snakefile" in ended.stdout


LEAVES_OUT = """
from pathlib import Path

from visuohaptic.geometry.surface import write_set_aside
from visuohaptic_workflow.jobs import job

with job(snakemake):
    for key in snakemake.params.models:
        path = Path(snakemake.output[0], f"{key}.ply")
        path.parent.mkdir(parents=True, exist_ok=True)
        if key == "bottle/a":
            write_set_aside(path, "meshes/own/bottle/a.stl has no faces.")
"""


def test_a_failed_run_names_objects_that_were_left_out(mine, whole_stand_in, tmp_path):
    clone = whole_stand_in.copy(tmp_path / "broken clone")
    (clone.folder / "workflow/scripts/meshes.py").write_text(LEAVES_OUT)
    (clone.folder / "workflow/scripts/fixations.py").write_text("raise SystemExit(1)\n")
    add(mine, *ENOUGH)
    ended = replace(mine, clone=clone.folder).snakemake(
        "-s", str(clone.folder / "Snakefile"), check=False
    )
    assert ended.returncode == 1
    assert ended.stdout.count("bottle/a was left out: meshes/own/bottle/a.stl has no faces.\n") == 1
