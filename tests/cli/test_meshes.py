"""`visuohaptic meshes` brings, checks and credits models, and says in a sentence what is wrong."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
import trimesh

ROOT = Path(__file__).parents[2]


def visuohaptic(*arguments, folder=ROOT):
    program = "from visuohaptic.cli.main import main; main()"
    return subprocess.run(
        [sys.executable, "-c", program, *arguments],
        cwd=folder, capture_output=True, text=True, check=False,
        env={"PYTHONPATH": str(ROOT / "src"), "PATH": "", "NO_COLOR": "1"},
    )  # fmt: skip


@pytest.fixture
def folder(tmp_path):
    """A meshes folder with the paper's set and one own object."""
    (tmp_path / "meshes" / "own" / "cup").mkdir(parents=True)
    (tmp_path / "meshes" / "paper").symlink_to(ROOT / "meshes" / "paper")
    (tmp_path / "meshes" / "catalogue.csv").symlink_to(ROOT / "meshes" / "catalogue.csv")
    trimesh.creation.cylinder(1, 2).export(tmp_path / "meshes" / "own" / "cup" / "can.stl")
    return tmp_path


def test_check_finds_every_shipped_and_own_object_touchable(folder):
    result = visuohaptic("meshes", "check", folder=folder)
    assert result.returncode == 0
    assert "cup/can: " in result.stdout
    assert result.stdout.endswith("13 of 13 models can be touched.\n")


def test_check_names_a_broken_file_and_ends_with_1(folder):
    (folder / "meshes" / "own" / "cup" / "bad.obj").write_text("nothing")
    result = visuohaptic("meshes", "check", "--json", folder=folder)
    assert result.returncode == 1
    findings = json.loads(result.stdout)
    assert "bad.obj" in findings["cup/bad"]["error"]
    assert findings["cup/can"]["triangles"] > 0


def test_credits_name_author_and_licence():
    result = visuohaptic("meshes", "credits")
    assert "car/kl_VW-new-beetle: Andrew Kator & Jennifer Legaz, CC-BY-3.0-US\n" in result.stdout


def test_credits_are_parsed_by_machines():
    named = json.loads(visuohaptic("meshes", "credits", "--set", "benchmark", "--json").stdout)
    assert len(named) == 142


def test_a_missing_catalogue_is_one_sentence_and_1(tmp_path):
    result = visuohaptic("meshes", "check", folder=tmp_path)
    assert result.returncode == 1
    assert (
        result.stderr
        == "error: the catalogue meshes/catalogue.csv can't be read: No such file or directory.\n"
    )


def test_debug_shows_where_an_error_arose(tmp_path):
    result = visuohaptic("--debug", "meshes", "check", folder=tmp_path)
    assert "Traceback" in result.stderr


def test_wrong_use_ends_with_2():
    assert visuohaptic("meshes", "check", "--set", "everything").returncode == 2
    assert visuohaptic("mashes").returncode == 2


@pytest.mark.parametrize("command", ["fetch", "check", "credits"])
def test_help_gives_an_example(command):
    assert (
        f"Example: visuohaptic meshes {command}" in visuohaptic("meshes", command, "--help").stdout
    )
