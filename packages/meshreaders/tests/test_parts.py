"""Parts become one surface, part after part, without the vertices that no face names."""

import numpy as np
import pytest
from mesh_files.generated import BOARD
from PIL import Image

from meshreaders.base.errors import MeshError
from meshreaders.base.texture import NO_IMAGE
from meshreaders.parts import GREY, Paint, Part, join_parts

TRIANGLE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
FACE = np.array([[0, 1, 2]])


def test_parts_keep_their_order_triangles_and_colours():
    red = np.array([[255, 0, 0]], np.uint8)
    surface = join_parts(
        [Part(TRIANGLE, FACE), Part(TRIANGLE + 5, FACE, red), Part(TRIANGLE, FACE[:0])]
    )
    np.testing.assert_array_equal(surface.triangles, [TRIANGLE, TRIANGLE + 5])
    np.testing.assert_array_equal(surface.face_colours, [GREY, [255, 0, 0]])
    assert surface.texture is None


def test_vertices_that_no_face_names_are_left_out_whatever_they_are():
    points = np.concatenate(
        [[[np.nan] * 3], TRIANGLE[:1], [[1e300, 0, 0]], TRIANGLE[1:], [[0, 0, np.inf]]]
    )
    surface = join_parts([Part(points, np.array([[4, 1, 3]]))] * 2)
    np.testing.assert_array_equal(surface.vertices, np.concatenate([TRIANGLE] * 2))
    np.testing.assert_array_equal(surface.faces, [[2, 0, 1], [5, 3, 4]])


def test_parts_of_one_image_share_it_and_others_have_none():
    corners = TRIANGLE[None, :, :2]
    image = Image.fromarray(BOARD)
    painted = Part(TRIANGLE, FACE, None, Paint(image, corners))
    tinted = Part(TRIANGLE, FACE, None, Paint(image, corners, tint=(0.5, 1.0, 1.0)))
    texture = join_parts([painted, Part(TRIANGLE, FACE), painted, tinted]).texture
    assert texture.image.tolist() == [0, NO_IMAGE, 0, 1]
    np.testing.assert_array_equal(texture.corners[0], corners[0])


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        ([], "no faces"),
        ([Part(TRIANGLE, FACE[:0])], "no faces"),
        ([Part(TRIANGLE, FACE + 1), Part(TRIANGLE, FACE)], "names vertex 3; 0 to 2"),
        ([Part(TRIANGLE, FACE - 1)], "names vertex -1"),
        ([Part(TRIANGLE[:, :2], FACE)], r"vertices have the shape \(3, 2\)"),
        ([Part(TRIANGLE, np.zeros((1, 4), int))], r"faces have the shape \(1, 4\)"),
        (
            [Part(TRIANGLE, FACE, None, Paint(Image.fromarray(BOARD), np.zeros((2, 3, 2))))],
            "coordinates have the shape",
        ),
    ],
)
def test_parts_that_are_no_surface_are_refused(parts, says):
    with pytest.raises(MeshError, match=says):
        join_parts(parts)
