"""The picture of how objects stand: the view, the arrows to front and up, class and name."""

import numpy as np
import pytest
import trimesh
from PIL import Image

from visuohaptic.exploration import standing
from visuohaptic.exploration.standing import CELL_PIXELS, draw_standing, join_cells
from visuohaptic.geometry.surface import Surface
from visuohaptic.geometry.turning import turn_surface
from visuohaptic.meshes.preparing import normalise
from visuohaptic.parameters import ExperimentParameters

QUARTER = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])


@pytest.fixture(scope="module")
def block():
    """A red block, wide from the front and twice as high."""
    mesh = trimesh.creation.box((1.0, 2.0, 0.2))
    colours = np.full((len(mesh.faces), 3), (255, 0, 0), np.uint8)
    surface = Surface(np.array(mesh.vertices), np.array(mesh.faces), colours)
    return normalise(surface, "block").surface


def pixels_of(cell, colour):
    """Return rows and columns of the pixels of a colour."""
    return np.nonzero((np.asarray(cell)[:CELL_PIXELS] == colour).all(axis=-1))


def red(cell):
    pixels = np.asarray(cell)[:CELL_PIXELS].astype(int)
    return np.nonzero((pixels[..., 0] > 60) & (pixels[..., 1] == 0))


def test_up_is_above_the_object_and_front_below_in_front_of_its_foot(block):
    cell = draw_standing("box/block", block, ExperimentParameters())
    rows, columns = red(cell)
    up_rows, up_columns = pixels_of(cell, standing._UP)
    front_rows, _ = pixels_of(cell, standing._FRONT)
    assert up_rows.min() < rows.min() - 20
    assert abs(up_rows.max() - rows.min()) < 5
    assert front_rows.min() > rows.max() - 5
    assert abs(up_columns.min() - CELL_PIXELS / 2) < 20
    # Perspective: twice as high as wide, seen 20° from above.
    assert 1.5 < np.ptp(rows) / np.ptp(columns) < 2.1


def test_the_view_is_from_the_front(block):
    narrow = draw_standing("box/block", turn_surface(block, QUARTER), ExperimentParameters())
    assert np.ptp(red(narrow)[1]) < 0.4 * np.ptp(
        red(draw_standing("box/block", block, ExperimentParameters()))[1]
    )


@pytest.mark.parametrize(
    "viewpoints",
    [{"distance": 1.01}, {"projection": "orthographic"}, {"arrangement": "fibonacci"}],
)
def test_arrows_are_drawn_for_every_arrangement(block, viewpoints):
    parameters = ExperimentParameters.from_mapping({"viewpoints": viewpoints})
    cell = draw_standing("box/block", block, parameters)
    for colour in (standing._UP, standing._FRONT):
        assert len(pixels_of(cell, colour)[0]) > 50


def test_class_and_name_are_beneath_and_a_long_name_is_cut(block):
    beneath = [
        np.asarray(draw_standing(key, block, ExperimentParameters()))[CELL_PIXELS:]
        for key in ("box/block", "Box/block", "box/Öl", "box/Öy", f"box/{'m' * 100}")
    ]
    assert all((lines < 128).any() for lines in beneath)
    for first, second in ((0, 1), (0, 2), (2, 3)):
        assert (beneath[first] != beneath[second]).any()
    # Margins of a cut name are white.
    assert (beneath[4][:, [0, -1]] == 255).all()


def test_cells_are_arranged_in_a_square_in_their_order(block):
    cell = draw_standing("box/block", block, ExperimentParameters())
    for count, across, down in ((1, 1, 1), (3, 2, 2), (9, 3, 3), (10, 4, 3)):
        picture = join_cells([cell] * count)
        assert picture.width // (cell.width + 8) == across
        assert picture.height // (cell.height + 8) == down
        last = np.asarray(picture)[-cell.height :, -cell.width - 16 :]
        assert (last == 255).all() == (count < across * down)


def test_cells_are_arranged_in_rows_of_a_given_length():
    cell = Image.new("RGB", (20, 10), "black")
    assert join_cells([cell] * 10, 5).size == (5 * 28 + 8, 2 * 18 + 8)
    assert join_cells([cell] * 4, 5).size == (5 * 28 + 8, 18 + 8)
