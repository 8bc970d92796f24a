"""`visuohaptic meshes` brings, checks and credits models, and says in a sentence what is wrong."""

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from visuohaptic.exploration.standing import CELL_PIXELS

ROOT = Path(__file__).parents[2]


@pytest.fixture
def folder(tmp_path):
    """A meshes folder with the paper's set and one own object."""
    (tmp_path / "meshes" / "own" / "cup").mkdir(parents=True)
    (tmp_path / "meshes" / "paper").symlink_to(ROOT / "meshes" / "paper")
    (tmp_path / "meshes" / "catalogue.csv").symlink_to(ROOT / "meshes" / "catalogue.csv")
    trimesh.creation.cylinder(1, 2).export(tmp_path / "meshes" / "own" / "cup" / "can.stl")
    return tmp_path


@pytest.mark.slow
def test_check_finds_shipped_and_own_objects_touchable_and_names_a_broken_file(visuohaptic, folder):
    result = visuohaptic("meshes", "check", folder=folder)
    assert result.code == 0
    assert "cup/can " in result.out
    assert "13 of 13 files can be touched.\n" in result.out
    (folder / "meshes" / "own" / "cup" / "bad.obj").write_text("nothing")
    result = visuohaptic("meshes", "check", "--json", folder=folder)
    assert result.code == 1
    findings = json.loads(result.out)
    assert "bad.obj" in findings["cup/bad"]["error"]
    assert findings["cup/can"]["triangles"] > 0


def test_a_set_that_was_not_brought_is_said_to_be(visuohaptic, folder):
    ended = visuohaptic("meshes", "check", "--set", "hard", folder=folder)
    assert ended.code == 1
    assert "of set hard are not there, such as potted_plant/" in ended.err
    assert "run `make meshes SET=hard`" in ended.err


def test_credits_name_author_and_licence(visuohaptic):
    result = visuohaptic("meshes", "credits", folder=ROOT)
    assert "car/kl_VW-new-beetle: Andrew Kator & Jennifer Legaz, CC-BY-3.0-US\n" in result.out
    result = visuohaptic("meshes", "credits", "--set", "benchmark", "--json", folder=ROOT)
    assert len(json.loads(result.out)) == 142


def test_a_missing_catalogue_is_one_sentence_and_1(visuohaptic, tmp_path):
    result = visuohaptic("meshes", "check", folder=tmp_path)
    assert result.code == 1
    assert result.err.startswith("error: the catalogue meshes/catalogue.csv can't be read: No such")


@pytest.fixture
def own(visuohaptic, tmp_path):
    """A folder of `visuohaptic new`, without any model of the paper, and the function that adds an object."""
    visuohaptic("new", "mine", "cup", "box")
    folder = tmp_path / "mine"

    def add(key, mesh=None):
        file = folder / f"meshes/own/{key}"
        file.parent.mkdir(exist_ok=True)
        (mesh or trimesh.creation.box((1, 2, 3))).export(file)
        return file

    return folder, add


def test_own_objects_alone_are_listed_in_lines_and_shown_in_a_picture(visuohaptic, own):
    folder, add = own
    for name in ("a", "b"):
        add(f"cup/{name}.stl", trimesh.creation.cylinder(1, 0.1))
        add(f"box/{name}.obj")
    ended = visuohaptic("meshes", "check", folder=folder)
    assert ended.code == 0, ended.err
    heading, *lines = ended.out.splitlines()
    assert heading.split() == [
        "object",
        *["width", "×", "height", "×", "depth", "faces", "usable", "notes"],
    ]
    assert lines[0].split() == ["box/a", "1", "×", "2", "×", "3", "12", "yes"]
    assert lines[2].split()[:6] == ["cup/a", "2", "×", "2", "×", "0.1"]
    assert "cup/a.stl is taken as y-up, and would stand more steadily with z up" in lines[2]
    assert lines[4] == "4 of 4 files can be touched."
    assert lines[5].startswith("reports/objects.png shows how the objects stand")
    with Image.open(folder / "reports/objects.png") as picture:
        assert picture.width > 2 * CELL_PIXELS
        assert len(np.unique(np.asarray(picture))) > 50


def test_the_check_takes_the_parameters_of_the_folder(visuohaptic, own):
    folder, add = own
    add("cup/a.stl", trimesh.creation.cylinder(1, 4))
    with (folder / "params.yaml").open("a") as stream:
        stream.write("  own_up_axis: z\n")
    assert "cup/a   2 × 4 × 2 " in visuohaptic("meshes", "check", folder=folder).out
    (folder / "params.yaml").write_text("meshes:\n  set: own\n  merge_tolerance: 1\n")
    ended = visuohaptic("meshes", "check", folder=folder)
    assert ended.code == 1
    assert ended.err.startswith("error: params.yaml: meshes.merge_tolerance is no parameter")
    (folder / "params.yaml").write_text("meshes:\n  set: mine\n")
    ended = visuohaptic("meshes", "check", folder=folder)
    assert ended.err.startswith("error: params.yaml: meshes.set is 'mine': paper, ")
    assert "'mine' is not one of 'paper'" in visuohaptic("meshes", "check", "--set", "mine").err


def test_an_empty_folder_is_a_sentence_and_no_picture(visuohaptic, own):
    folder, _ = own
    ended = visuohaptic("meshes", "check", folder=folder)
    assert (ended.code, ended.out) == (1, "")
    assert ended.err.startswith(
        "error: There are no objects: meshes.set is own, and meshes/own has"
    )
    assert ended.err.count("\n") == 1
    assert not (folder / "reports").exists()


@pytest.mark.parametrize(
    ("names", "says"),
    [
        (("cup/a.stl",), "and no class has them: put objects into meshes/own/<class>/"),
        (("cup/a.stl", "cup/b.stl"), "and only cup has them: put objects into meshes/own/<class>/"),
        (("cup/a.stl", "cup/b.stl", "box/a.stl"), "and only cup has them"),
    ],
)
def test_too_few_objects_to_recognise_are_said_after_the_lines(visuohaptic, own, names, says):
    folder, add = own
    for name in names:
        add(name)
    ended = visuohaptic("meshes", "check", folder=folder)
    assert ended.code == 1
    assert f"{len(names)} of {len(names)} files can be touched.\n" in ended.out
    assert ended.err.startswith("error: Recognition needs two classes with two objects each, ")
    assert says in ended.err
    assert ended.err.count("\n") == 1
    assert (folder / "reports/objects.png").is_file()


def test_a_file_that_can_not_be_used_is_named_and_the_others_are_shown(visuohaptic, own):
    folder, add = own
    for name in ("cup/a.stl", "cup/b.stl", "Schüssel für Obst/a.stl", "Schüssel für Obst/b.obj"):
        add(name)
    add("cup/a.obj")
    add("cup/c.stl").write_text("nothing")
    ended = visuohaptic("meshes", "check", folder=folder)
    assert (ended.code, ended.err) == (1, "")
    lines = ended.out.splitlines()
    assert "is object cup/a, as meshes/own/cup/a.obj is already; rename one of them." in lines[1]
    assert [line[:20] for line in lines if line.endswith("yes")] == [
        "Schüssel für Obst/a ", "Schüssel für Obst/b ", "cup/a               ", "cup/b               ",
    ]  # fmt: skip
    [broken] = [line for line in lines if line.startswith("cup/c ")]
    assert broken.split()[1] == "no"
    assert "meshes/own/cup/c.stl" in broken
    assert "4 of 6 files can be touched." in lines
    assert (folder / "reports/objects.png").is_file()


def test_a_picture_that_can_not_be_written_is_a_sentence_after_the_lines(visuohaptic, own):
    folder, add = own
    add("cup/a.stl")
    (folder / "reports").touch()
    ended = visuohaptic("meshes", "check", folder=folder)
    assert ended.code == 1
    assert "1 of 1 files can be touched." in ended.out
    assert ended.err.startswith("error: ")
    assert "reports" in ended.err
    assert ended.err.count("\n") == 1
