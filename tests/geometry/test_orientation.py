import numpy as np
import pytest
from sensor.shapes import box, joined, sheet, surface_of

from visuohaptic.geometry.orientation import orient_outwards
from visuohaptic.geometry.raycasting import RayCaster


def test_normals_turn_outwards_whatever_the_winding():
    cube = box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))
    outward = np.concatenate([np.eye(3), -np.eye(3)])
    points = np.where(outward == 0, 0.01, 0.5 * outward)
    given = outward * np.array([1, -1, 1, -1, 1, -1])[:, None]
    np.testing.assert_array_equal(orient_outwards(RayCaster(cube), points, given), outward)


def test_a_single_sheet_is_touched_from_the_side_away_from_the_centre():
    leaf, point = sheet(lambda x, z: 0.2 + 0 * x, half=0.3, cells=4), np.array([[0.01, 0.2, 0.02]])
    for given in (leaf.face_normals[:1], -leaf.face_normals[:1]):
        normals = orient_outwards(RayCaster(leaf), point, given)
        np.testing.assert_allclose(normals, [[0, 1, 0]], atol=1e-12)


@pytest.mark.parametrize(
    "parts",
    [
        (box((-0.6,) * 3, (0.6,) * 3), box((-0.5,) * 3, (-0.4, 0.5, 0.5))),
        (box((-0.5,) * 3, (0.5,) * 3), box((-0.4,) * 3, (0.9,) * 3)),
    ],
    ids=["closed in by an outer box", "within two solids that overlap"],
)
def test_an_inner_wall_is_touched_from_the_wider_side(parts):
    caster, given = RayCaster(joined(*parts)), np.array([[-1.0, 0, 0]])
    normals = orient_outwards(caster, np.array([[-0.4, 0.01, 0.02]]), given)
    np.testing.assert_array_equal(normals, -given)


@pytest.mark.parametrize("winding", [1, -1])
def test_both_walls_of_a_gap_narrower_than_them_are_touched_from_within_the_gap(winding):
    left = box((-0.55, -0.5, -0.5), (-0.05, 0.5, 0.5))
    right = box((0.05, -0.5, -0.5), (0.55, 0.5, 0.5))
    both = joined(left, right)
    caster = RayCaster(surface_of(both.vertices, both.faces[:, ::winding]))
    points = np.array([[-0.05, 0.01, 0.02], [0.05, 0.01, 0.02]])
    outward = np.array([[1.0, 0, 0], [-1.0, 0, 0]])
    for given in (outward, -outward):
        np.testing.assert_array_equal(orient_outwards(caster, points, given), outward)
