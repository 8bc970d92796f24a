"""`visuohaptic new` makes a folder for own objects, changes no existing file, and says what is wrong in a sentence."""

import ast
import os
import stat
from pathlib import Path

import pytest

from visuohaptic.cli import new
from visuohaptic.parameters import ExperimentParameters, read_parameters

ROOT = Path(__file__).parents[2]


def contents(folder):
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*.*")}


def test_a_new_folder_has_only_what_differs_and_the_path_of_the_workflow(visuohaptic, tmp_path):
    ended = visuohaptic("new", "mine", "cup", "Tasse für Tee")
    assert ended.code == 0, ended.err
    assert len(ended.out.splitlines()) == 3
    assert "mine/meshes/own/<class>/" in ended.out
    folder = tmp_path / "mine"
    parameters = read_parameters(folder / "params.yaml")
    assert parameters == ExperimentParameters.from_mapping({"meshes": {"set": "own"}})
    assert f'include: "{ROOT}/workflow/Snakefile"\n' in (folder / "Snakefile").read_text()
    profile = "profiles/default/profile.yaml"
    assert (folder / profile).read_text() == (ROOT / profile).read_text()
    assert sorted(file.name for file in (folder / "meshes/own").iterdir()) == [
        "Tasse für Tee",
        "cup",
    ]
    assert not [*folder.rglob("*.ply.gz")]


def test_classes_need_not_be_named_and_meshes_may_be_there_already(visuohaptic, tmp_path):
    mesh = tmp_path / "mine/meshes/own/cup/a.stl"
    mesh.parent.mkdir(parents=True)
    mesh.write_text("solid")
    assert visuohaptic("new", "mine").code == 0
    names = sorted(file.name for file in (tmp_path / "mine/meshes/own").iterdir())
    assert names == ["cup", "first_class", "second_class"]
    assert mesh.read_text() == "solid"


@pytest.mark.parametrize("name", ["params.yaml", "Snakefile", "profiles/default/profile.yaml"])
def test_no_file_is_overwritten(visuohaptic, tmp_path, name):
    existing = tmp_path / "mine" / name
    existing.parent.mkdir(parents=True)
    existing.write_text("mine")
    before = contents(tmp_path)
    ended = visuohaptic("new", "mine", "cup")
    assert ended.code == 1
    assert ended.err == (
        f"error: mine/{name} exists already, and no file is overwritten; name another folder.\n"
    )
    assert contents(tmp_path) == before
    assert not (tmp_path / "mine/meshes").exists()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("mine", "a/b"), "error: CLASS: 'a/b' can't name a class or an object; 1 to 100"),
        (("mine", "cup", "--clone", "elsewhere"), "in a clone of the repository, not in the"),
        (("file/mine",), "file is a file; a folder is needed."),
        (("",), "the name is empty"),
    ],
)
def test_what_can_not_be_made_is_a_sentence_and_nothing_is_left(
    visuohaptic, tmp_path, arguments, says
):
    (tmp_path / "file").touch()
    ended = visuohaptic("new", *arguments)
    assert ended.code in {1, 2}
    assert says in ended.err
    assert "Traceback" not in ended.err
    assert [file.name for file in tmp_path.iterdir()] == ["file"]


def test_a_folder_without_permission_is_named(visuohaptic, tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("visuohaptic.cli.printing.tempfile.TemporaryFile", refuse)
    ended = visuohaptic("new", "mine")
    assert ended.code == 2
    assert "mine can't be written: Permission denied." in ended.err
    assert not (tmp_path / "mine").exists()


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_of_someone_else_is_named(visuohaptic, tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine").chmod(stat.S_IRUSR | stat.S_IXUSR)
    assert "mine can't be written: Permission denied." in visuohaptic("new", "mine").err


def test_a_path_with_a_quote_is_the_same_path_in_the_snakefile(visuohaptic, tmp_path):
    clone = tmp_path / 'my "clone"'
    for name in (new.WORKFLOW, new.PROFILE):
        (clone / name).parent.mkdir(parents=True)
        (clone / name).touch()
    assert visuohaptic("new", "mine", "--clone", clone).code == 0
    lines = (tmp_path / "mine/Snakefile").read_text().splitlines()
    [included] = [line for line in lines if line.startswith("include: ")]
    path = ast.literal_eval(included.removeprefix("include: "))
    assert path == str(clone / new.WORKFLOW)
