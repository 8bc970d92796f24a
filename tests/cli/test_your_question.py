"""All code and commands of docs/your_question.md run, and give what the page says."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from docs.shell_commands import block_commands, blocks
from report.synthetic import lay_out

import visuohaptic as vh

PAGE = Path(__file__).parents[2] / "docs" / "your_question.md"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a mug of 8 cm and two finished runs."""
    folder = lay_out(tmp_path_factory.mktemp("question"))
    (folder / "before").mkdir()
    lay_out(folder / "before")
    trimesh.creation.annulus(32, 40, 80).export(folder / "mug.obj")
    return folder


def run_block(text, folder, monkeypatch):
    [code] = [found for found in blocks(PAGE, "python") if text in found]
    monkeypatch.chdir(folder)
    names = {}
    exec(compile(code, PAGE.name, "exec"), names)  # noqa: S102
    return names


def test_every_block_of_python_has_a_test_here():
    tested = ("fsr400", "indentation", "largest_size", "RayCaster", "attend(")
    found = [[text in code for text in tested] for code in blocks(PAGE, "python")]
    assert np.array_equal(np.sum(found, axis=0), np.ones(len(tested)))
    assert np.array_equal(np.sum(found, axis=1), np.ones(len(found)))


def test_an_array_is_pressed_on_a_mesh_and_reads_pressure(folder, monkeypatch):
    felt = run_block("fsr400", folder, monkeypatch)["felt"]
    assert felt.images.shape == (3, 16, 16)
    assert 0 < felt.images.max() <= 1


def test_a_depth_map_has_the_size_of_the_sensor_and_the_depth_of_the_press(folder, monkeypatch):
    names = run_block("indentation", folder, monkeypatch)
    assert names["indentation"].shape == (1, 480, 640)
    assert names["indentation"].min() == 0
    assert names["indentation"][0, 240, 320] == pytest.approx(1, abs=1e-3)
    assert names["felt"].sizes.tolist() == [[18.9, 14.2]]
    assert round(0.0295 * 640, 1) == 18.9
    assert round(0.0295 * 480, 1) == 14.2


def test_a_square_of_the_experiment_has_the_true_size_of_the_sensor(folder, monkeypatch):
    names = run_block("largest_size", folder, monkeypatch)
    touched = names["touched"]
    assert touched.imprints.shape == (10, 64, 64)
    sizes = np.array(touched.touches["sensor_size"]) * names["thing"].frame.radius
    assert sizes == pytest.approx(14.2, abs=1e-5)


def test_a_ray_meets_the_surface_exactly(folder, monkeypatch):
    names = run_block("RayCaster", folder, monkeypatch)
    [face], [distance] = names["hits"].face, names["hits"].distance
    triangle = vh.example("bottle").surface.triangles[face]
    normal = np.cross(*(triangle[1:] - triangle[0]))
    hit = np.array([0.0, 0.0, 3.0 - distance])
    assert names["hits"].hit.all()
    assert (hit - triangle[0]) @ normal / np.linalg.norm(normal) == pytest.approx(0, abs=1e-14)


def test_the_red_square_of_a_picture_is_the_most_salient(folder, monkeypatch):
    names = run_block("attend(", folder, monkeypatch)
    assert 40 <= names["row"] < 56
    assert 70 <= names["column"] < 86


def test_the_commands_of_the_page_run(folder, visuohaptic, monkeypatch):
    monkeypatch.chdir(folder)
    commands = block_commands(PAGE)
    assert commands
    for program, *arguments in commands:
        assert program == "visuohaptic"
        ended = visuohaptic(*arguments)
        assert ended.code == 0, ended.err
