"""Meshes of trimesh and Open3D in memory are the surfaces that their files would be."""

from importlib import import_module
from importlib.util import find_spec

import numpy as np
import pytest
import trimesh
from meshes.generated import BOARD, SQUARE, write_square

from visuohaptic.base.errors import MeshError
from visuohaptic.exploration.pressing import press
from visuohaptic.geometry.surface import Surface
from visuohaptic.meshes.model_files import read_mesh
from visuohaptic.meshes.parts import GREY

POINTS, FACES = (
    np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]),
    np.array([[0, 1, 2], [0, 2, 3]]),
)


def load_open3d():
    """Return Open3D, after the library loaded the USB library that a bare machine lacks."""
    if find_spec("open3d") is None:
        pytest.skip("needs Open3D")
    import_module("visuohaptic.geometry.compiled_open3d")
    return import_module("open3d")


def open3d_square():
    open3d = load_open3d()
    vector = open3d.utility
    return open3d.geometry.TriangleMesh(vector.Vector3dVector(POINTS), vector.Vector3iVector(FACES))


def forms(mesh):
    return mesh, load_open3d().t.geometry.TriangleMesh.from_legacy(mesh)


def test_a_mesh_of_open3d_is_read_with_the_colours_of_its_vertices():
    plain, red = open3d_square(), open3d_square()
    red.paint_uniform_color([1, 0.5, 0])
    for mesh in forms(plain):
        surface = read_mesh(mesh)
        np.testing.assert_array_equal(surface.triangles, POINTS[FACES])
        np.testing.assert_array_equal(surface.face_colours, [GREY] * 2)
        assert press(mesh, [[0.5, 0.5, 0]], [[0, 0, 1]], 0.1, resolution=4).images.min() == 1
    for mesh in forms(red):
        np.testing.assert_array_equal(read_mesh(mesh).face_colours, [[255, 128, 0]] * 2)


def test_an_image_of_a_mesh_of_open3d_lies_where_that_of_its_file_does(tmp_path):
    open3d = load_open3d()
    text = SQUARE.replace("f 1/1 2/2 3/3 4/4", "f 1/1 2/2 3/3\nf 1/1 3/3 4/4")
    path = write_square(tmp_path, BOARD[:4], text=text)
    expected = read_mesh(path).texture
    found = read_mesh(open3d.io.read_triangle_mesh(str(path), enable_post_processing=True)).texture
    np.testing.assert_array_equal(found.images[0], expected.images[0])
    np.testing.assert_allclose(
        np.sort(found.corners.reshape(-1, 2), axis=0),
        np.sort(expected.corners.reshape(-1, 2), axis=0),
    )


def test_a_surface_is_a_source_and_stays_as_it_is():
    surface = read_mesh((POINTS, FACES))
    assert read_mesh(surface) is surface
    assert isinstance(surface, Surface)


@pytest.mark.parametrize(
    ("source", "says"),
    [
        (7, "type int; a path, .* are? needed|type int"),
        ([POINTS, FACES], "type list"),
        ((POINTS, FACES, FACES), "type tuple"),
        (trimesh.PointCloud(POINTS), "type PointCloud"),
        (trimesh.Scene(), "no faces"),
        ((POINTS, FACES.astype(bool)), "faces of bool"),
        ((POINTS * 1j, FACES), "vertices of complex"),
        ((POINTS, FACES - 1), "names vertex -1"),
    ],
)
def test_what_is_no_mesh_is_refused_by_its_type(source, says):
    with pytest.raises(MeshError, match=says):
        read_mesh(source)
