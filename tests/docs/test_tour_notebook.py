"""The notebook of the tour runs from its first cell to its last without a run, and is stored with what it shows."""

import ast
import os
import re
from pathlib import Path

import nbclient
import nbformat
import pytest
from source_folders import PYTHONPATH

from visuohaptic.pictures.imprint_scale import imprint_scale
from visuohaptic.scene.parameters import Scene
from visuohaptic.sensor.parameters import SensorParameters

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.slow
NOTEBOOK = ROOT / "docs" / "tour.ipynb"
PICTURES = [1, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0]
"""How many pictures each cell shows."""
MODELS = [0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0]
"""How many models that can be turned each cell shows."""


@pytest.fixture(scope="module")
def tour():
    return nbformat.read(NOTEBOOK, as_version=4)


@pytest.fixture(scope="module")
def ran(tour, tmp_path_factory):
    """The cells after a run in an empty folder: neither models nor results of a run are at hand."""
    here = {"metadata": {"path": str(tmp_path_factory.mktemp("tour"))}}
    client = nbclient.NotebookClient(tour, timeout=120, resources=here)
    ran = client.execute(env={**os.environ, "PYTHONPATH": PYTHONPATH})
    return [cell for cell in ran.cells if cell.cell_type == "code"]


def shown(cell, kind):
    return [output["data"][kind] for output in cell.outputs if kind in output.get("data", {})]


def pictures(cell):
    """Count the PNG pictures, as data or within HTML."""
    within = [text.count("data:image/png;base64,") for text in shown(cell, "text/html")]
    return len(shown(cell, "image/png")) + sum(within)


def models(cell):
    return sum(text.startswith("<iframe srcdoc=") for text in shown(cell, "text/html"))


def test_it_is_stored_with_what_each_cell_shows():
    stored = nbformat.read(NOTEBOOK, as_version=4)
    nbformat.validate(stored)
    cells = [cell for cell in stored.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    assert [len(shown(cell, "text/plain")) for cell in cells] == [1] * len(cells)
    assert list(map(pictures, cells)) == PICTURES
    assert list(map(models, cells)) == MODELS
    assert NOTEBOOK.stat().st_size < 300_000


def test_every_cell_shows_what_it_promises_and_says_nothing_on_the_side(ran):
    assert not [output for cell in ran for output in cell.outputs if "text" in output]
    assert "chair/kl_dining-chair" in shown(ran[0], "text/html")[0]
    assert list(map(pictures, ran)) == PICTURES
    assert list(map(models, ran)) == MODELS
    assert "contact_state" in shown(ran[4], "text/html")[0]
    assert "(2, 16, 16)" in shown(ran[7], "text/plain")[0]
    assert "contourlet_16" in shown(ran[8], "text/html")[0]
    assert ": chair " in shown(ran[9], "text/plain")[0]
    assert ": unknown (" in shown(ran[10], "text/plain")[0]


def test_squares_shrink_as_often_as_stored(ran, tour):
    smaller = ast.literal_eval(shown(ran[6], "text/plain")[0])
    stored = nbformat.read(NOTEBOOK, as_version=4)
    cells = [cell for cell in stored.cells if cell.cell_type == "code"]
    assert smaller == ast.literal_eval(shown(cells[6], "text/plain")[0])
    assert list(smaller) == ["fixation", "random"]


def test_light_means_the_same_as_in_the_report(tour):
    texts = " ".join(cell.source for cell in tour.cells)
    assert imprint_scale(SensorParameters(), Scene()).sentence in texts
    absolute = SensorParameters(normalisation="absolute")
    assert f"light is {imprint_scale(absolute, Scene()).light}" in texts


def test_no_object_is_classified_that_the_model_learnt(tour):
    classifying = [cell.source for cell in tour.cells if "recognise(" in cell.source]
    assert len(classifying) == 2
    assert "vh.example(" in tour.cells[1].source
    assert not any(re.search("meshes/|vh.load\\(root", cell.source) for cell in tour.cells)
