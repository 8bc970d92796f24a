"""What Python and a notebook print of objects, explorations and answers is short, and has a picture."""

import io

import pytest
import trimesh
from PIL import Image

import visuohaptic as vh

SMALL = {"rendering.resolution": 64}


@pytest.fixture(scope="module")
def felt(tmp_path_factory):
    path = tmp_path_factory.mktemp("ring") / "<b>ring.obj"
    trimesh.creation.torus(1, 0.4, 16, 8).export(path)
    return vh.load(path).touch(viewpoints=6, parameters=SMALL)


@pytest.fixture(scope="module")
def named(felt):
    return vh.Recognition("<i>car", {"<i>car": 0.75, "chair": 0.25}, felt, 30, {"name": 0.01})


def test_each_prints_one_short_line(felt, named):
    ready = vh.TouchableObject(felt.key, felt.surface, 0.0)
    assert repr(ready) == "<TouchableObject unknown/<b>ring: 256 triangles>"
    start = "<Exploration of unknown/<b>ring: 30 touches from 6 viewpoints by fixation, "
    assert repr(felt).startswith(start)
    assert repr(named).endswith("<b>ring: <i>car 75.0 %, chair 25.0 %; from 30 touches>")
    many = vh.Recognition("a", dict.fromkeys("abcdefgh", 0.125), felt, 30, {})
    assert "a 12.5 %, b 12.5 %, c 12.5 %, …; from" in repr(many)
    assert repr(felt.surface) == "<Surface: 128 vertices, 256 triangles>"


def test_a_notebook_shows_an_object_and_the_first_views_of_an_exploration(felt):
    with Image.open(io.BytesIO(felt._repr_png_())) as shown:
        assert shown.format == "PNG"
        assert shown.height < felt.picture().height
    ready = vh.TouchableObject(felt.key, felt.surface, 0.0)
    with Image.open(io.BytesIO(ready._repr_png_())) as shown:
        assert len(shown.convert("L").getcolors()) > 10


def test_a_notebook_shows_an_answer_as_a_table_that_runs_no_markup(named):
    shown = named._repr_html_()
    assert "&lt;i&gt;car" in shown
    assert "75.0" in shown
    assert "<i>" not in shown
    assert "<b>ring" not in shown
