"""The notebook of the tour runs from its first cell to its last, and is stored with what it shows."""

import ast
import os
from pathlib import Path

import nbclient
import nbformat
import pytest
from cli.models import fit_on_nonsense
from source_folders import PYTHONPATH

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.slow
NOTEBOOK = ROOT / "docs" / "tour.ipynb"
PICTURES = [1, 1, 0, 1, 0, 0, 0, 0, 0]
"""How many pictures each cell shows."""


@pytest.fixture(scope="module")
def tour():
    return nbformat.read(NOTEBOOK, as_version=4)


@pytest.fixture(scope="module")
def ran(tour, tmp_path_factory):
    folder = tmp_path_factory.mktemp("tour")
    for name in ("meshes", "params.yaml"):
        (folder / name).symlink_to(ROOT / name)
    fit_on_nonsense(folder / "results" / "models")
    here = {"metadata": {"path": str(folder)}}
    client = nbclient.NotebookClient(tour, timeout=120, resources=here)
    ran = client.execute(env={**os.environ, "PYTHONPATH": PYTHONPATH})
    return [cell for cell in ran.cells if cell.cell_type == "code"]


def shown(cell, kind):
    return [output["data"][kind] for output in cell.outputs if kind in output.get("data", {})]


def test_it_is_stored_with_what_each_cell_shows():
    stored = nbformat.read(NOTEBOOK, as_version=4)
    nbformat.validate(stored)
    cells = [cell for cell in stored.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    assert [len(shown(cell, "text/plain")) for cell in cells] == [1] * len(cells)
    assert [len(shown(cell, "image/png")) for cell in cells] == PICTURES
    assert NOTEBOOK.stat().st_size < 300_000


def test_every_cell_shows_what_it_promises_and_says_nothing_on_the_side(ran):
    assert not [output for cell in ran for output in cell.outputs if "text" in output]
    assert "chair/bs0_chair2" in shown(ran[0], "text/plain")[0]
    assert [len(shown(cell, "image/png")) for cell in ran] == PICTURES
    assert "contact_state" in shown(ran[2], "text/html")[0]
    assert "(2, 16, 16)" in shown(ran[5], "text/plain")[0]
    assert "contourlet_16" in shown(ran[6], "text/html")[0]
    assert "class" in shown(ran[7], "text/html")[0]


def test_squares_shrink_at_fixations_and_at_random_places(ran, tour):
    smaller = ast.literal_eval(shown(ran[4], "text/plain")[0])
    stored = [cell for cell in tour.cells if cell.cell_type == "code"]
    assert smaller == ast.literal_eval(shown(stored[4], "text/plain")[0])
    assert list(smaller) == ["fixation", "random"]
    for counted in smaller.values():
        shrunk, touches = map(int, counted.split(" of "))
        # "About half" of the text above the cell.
        assert 0.4 <= shrunk / touches <= 0.6


def test_no_object_is_classified_that_the_model_learnt(tour):
    classifying = [cell.source for cell in tour.cells if "recognise(" in cell.source]
    assert len(classifying) == 2
    assert not any("chair" in source for source in classifying)
