"""What Python and a notebook print of objects, explorations and answers is short, and has a picture."""

import base64
import io
import re

import pytest
import trimesh
from PIL import Image, ImageDraw

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
    warned = vh.Recognition(
        "a", {"a": 1.0}, felt, 30, {}, caution="Take care.", notes=("So.", "Do.")
    )
    assert repr(warned).endswith("<b>ring: a 100.0 %; from 30 touches. Take care. So. Do.>")
    assert repr(felt.surface) == "<Surface: 128 vertices, 256 triangles>"


def picture_of(shown):
    """Return the picture within an HTML text."""
    data = re.search(r'src="data:image/png;base64,([^"]+)"', shown)[1]
    return Image.open(io.BytesIO(base64.b64decode(data)))


def test_a_notebook_shows_a_small_picture_with_one_escaped_line(felt):
    ready = vh.TouchableObject(felt.key, felt.surface, 0.0)
    assert "unknown/&lt;b&gt;ring: 256 triangles" in ready._repr_html_()
    assert "&lt;b&gt;ring: 30 touches from 6 viewpoints by fixation" in felt._repr_html_()
    for shown in (ready._repr_html_(), felt._repr_html_()):
        assert "<b>" not in shown
        assert len(shown) < 50_000
        assert len(picture_of(shown).convert("L").getcolors()) > 10
    assert picture_of(felt._repr_html_()).height < felt.picture().height


def test_the_small_picture_of_many_touches_is_small(felt):
    points = felt.surface.triangles.mean(axis=1)
    given = vh.TouchableObject(felt.key, felt.surface, 0.0).touch(at=points, parameters=SMALL)
    shown = given._repr_html_()
    assert "256 touches at given points" in shown
    assert len(shown) < 50_000
    assert picture_of(shown).height < 500


def test_a_picture_says_what_light_is_in_an_imprint(felt, monkeypatch):
    drawn = []
    monkeypatch.setattr(ImageDraw.ImageDraw, "text", lambda _, at, text, **__: drawn.append(text))
    felt.picture()
    assert "dark: the imprint's farthest point (0); light: the imprint's nearest point (1)" in drawn


def test_a_notebook_shows_an_answer_as_a_table_that_runs_no_markup(named):
    shown = named._repr_html_()
    assert "&lt;i&gt;car" in shown
    assert "75.0" in shown
    assert "<i>" not in shown
    assert "<b>ring" not in shown
