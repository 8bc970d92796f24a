"""`visuohaptic meshes` brings, checks and credits models, and says in a sentence what is wrong."""

import json
from pathlib import Path

import pytest
import trimesh

ROOT = Path(__file__).parents[2]


@pytest.fixture
def folder(tmp_path):
    """A meshes folder with the paper's set and one own object."""
    (tmp_path / "meshes" / "own" / "cup").mkdir(parents=True)
    (tmp_path / "meshes" / "paper").symlink_to(ROOT / "meshes" / "paper")
    (tmp_path / "meshes" / "catalogue.csv").symlink_to(ROOT / "meshes" / "catalogue.csv")
    trimesh.creation.cylinder(1, 2).export(tmp_path / "meshes" / "own" / "cup" / "can.stl")
    return tmp_path


def test_check_finds_shipped_and_own_objects_touchable_and_names_a_broken_file(visuohaptic, folder):
    result = visuohaptic("meshes", "check", folder=folder)
    assert result.code == 0
    assert "cup/can: " in result.out
    assert result.out.endswith("13 of 13 files can be touched.\n")
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
