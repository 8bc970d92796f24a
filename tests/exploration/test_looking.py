"""`show` makes one page that needs no network, in a browser or within a notebook."""

import gzip
import json
import re
import sys
import webbrowser
from base64 import b64decode
from html import unescape
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

import visuohaptic as vh
from visuohaptic.exploration.looking import FACES_SHOWN, merge_cells
from visuohaptic.geometry.surface import Surface
from visuohaptic.tables.phases import POINT_NAMES
from visuohaptic.tables.schema import matrix

SMALL = {"rendering.resolution": 64}


@pytest.fixture(scope="module")
def felt(tmp_path_factory):
    path = tmp_path_factory.mktemp("ring") / "<b>ring & <script>alert(1).obj"
    trimesh.creation.torus(1, 0.4, 16, 8).export(path)
    return vh.load(path).touch(viewpoints=3, parameters=SMALL)


@pytest.fixture
def opened(monkeypatch):
    """The addresses that were opened instead of being shown in a browser."""
    addresses = []
    monkeypatch.setattr(webbrowser, "open", addresses.append)
    monkeypatch.delitem(sys.modules, "IPython", raising=False)
    return addresses


def part(page, name):
    return re.search(rf'<script[^>]* class="{name}">(.*?)</script>', page, re.DOTALL)[1]


def test_outside_of_a_notebook_a_page_is_written_and_opened(felt, opened):
    path = felt.show()
    assert opened == [path.as_uri()]
    assert path.name == "_b_ring_script_alert_1_.html"
    page = path.read_text(encoding="utf-8")
    assert "15 touches from 3 viewpoints by fixation" in page
    assert not re.findall(r'(?:src|href)="(?!data:)', page)
    assert "default-src &#x27;none&#x27;" in page
    assert "<b>" not in page
    assert "<script>alert" not in page


def test_the_page_holds_surface_touches_and_imprints(felt, tmp_path, opened):
    assert felt.show(tmp_path / "new" / "ring.html") == tmp_path / "new" / "ring.html"
    assert opened == []
    page = (tmp_path / "new" / "ring.html").read_text(encoding="utf-8")
    keys = json.loads(part(page, "touch-keys"))
    assert [key[:3] for key in keys[:6]] == [
        *(["fixation", 0, number] for number in range(1, 6)),
        ["fixation", 1, 1],
    ]
    assert [key[3] for key in keys] == felt.touches["contact_state"].to_pylist()
    assert list(json.loads(part(page, "imprint-sheets"))) == ["fixation"]
    assert 'data-faces="256"' in page
    data = gzip.decompress(b64decode(part(page, "geometry")))
    poses = np.frombuffer(data, "<i2")[3 * 128 :][: 10 * len(keys)].reshape(-1, 10) / 16384
    points = matrix(felt.touches, POINT_NAMES)
    np.testing.assert_allclose(poses[:, :3], points, atol=1e-4)
    options = re.findall(r'<option value="(\w+)" data-azimuth="([\d.]+)"', page)
    assert options == [("0", "0.00"), ("1", "120.00"), ("2", "240.00"), ("all", "0.00")]
    assert "light is the imprint&#x27;s nearest point (1)" in page


def test_a_folder_is_no_file_to_write(felt, tmp_path):
    with pytest.raises(
        vh.VisuohapticError, match=r"is a folder; show needs a file, such as .*model\.html\.$"
    ):
        felt.show(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_an_object_without_touches_and_touches_at_points_have_no_choice_of_a_view(
    felt, tmp_path, opened
):
    ready = vh.TouchableObject(felt.key, felt.surface, 0.0)
    bare = ready.show(tmp_path / "bare.html").read_text(encoding="utf-8")
    assert json.loads(part(bare, "touch-keys")) == []
    assert "<select" not in bare
    points = felt.surface.triangles.mean(axis=1)[:3]
    given = ready.touch(at=points, parameters=SMALL).show(tmp_path / "given.html")
    page = given.read_text(encoding="utf-8")
    assert len(json.loads(part(page, "touch-keys"))) == 3
    assert page.count("<label hidden>") == 2


def test_in_a_notebook_the_page_is_shown_inline(felt, monkeypatch):
    shown = []
    kernel = SimpleNamespace(kernel=1, display_pub=SimpleNamespace(publish=shown.append))
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: kernel))
    assert felt.show() is None
    frame = shown[0]["text/html"]
    assert frame.startswith('<iframe srcdoc="')
    page = unescape(re.search('srcdoc="([^"]+)"', frame)[1])
    assert page.startswith("<!DOCTYPE html>")
    assert 'data-focus=""' in page
    assert "<b>" not in frame
    assert "15 touches from 3 viewpoints by fixation" in shown[0]["text/plain"]


def test_ipython_in_a_terminal_opens_the_browser(felt, opened, monkeypatch):
    terminal = SimpleNamespace()
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: terminal))
    path = felt.show()
    assert opened == [path.as_uri()]


def test_a_large_surface_is_merged_to_the_faces_of_a_page_and_keeps_form_and_colours():
    ball = trimesh.creation.icosphere(6)
    red, blue = (255, 0, 0), (0, 0, 255)
    left = ball.triangles_center[:, :1] < 0
    colours = np.where(left, red, blue).astype(np.uint8)
    surface = Surface(np.asarray(ball.vertices), np.asarray(ball.faces), colours)
    assert len(surface.faces) > 4 * FACES_SHOWN
    merged = merge_cells(surface, FACES_SHOWN)
    assert FACES_SHOWN / 4 < len(merged.faces) <= FACES_SHOWN
    np.testing.assert_allclose(np.linalg.norm(merged.vertices, axis=1), 1, atol=0.02)
    assert merged.face_areas.sum() == pytest.approx(4 * np.pi, rel=0.05)
    sides = merged.triangles.mean(axis=1)[:, 0]
    np.testing.assert_array_equal(
        merged.face_colours[np.abs(sides) > 0.05],
        np.where(sides[:, None] < 0, red, blue)[np.abs(sides) > 0.05],
    )
    assert len(merge_cells(surface, 10).faces) <= 10
    assert merge_cells(surface, 10**6) is surface
