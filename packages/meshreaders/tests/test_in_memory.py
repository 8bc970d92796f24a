"""Meshes of trimesh and Open3D in memory are the surfaces that their files would be."""

import ctypes
import io
from importlib import import_module
from importlib.util import find_spec
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from mesh_files.generated import BOARD, SQUARE, write_square
from mesh_files.written_gltf import Gltf

import meshreaders
from meshreaders.base.errors import MeshError
from meshreaders.parts import GREY

POINTS, FACES = (
    np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]),
    np.array([[0, 1, 2], [0, 2, 3]]),
)


def load_open3d():
    """Return Open3D, after loading the USB library that a bare machine lacks, if a package has it."""
    if find_spec("libusb_package") is not None:
        ctypes.CDLL(str(import_module("libusb_package").get_library_path()), ctypes.RTLD_GLOBAL)
    return pytest.importorskip("open3d")


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
        surface = meshreaders.read(mesh)
        np.testing.assert_array_equal(surface.triangles, POINTS[FACES])
        np.testing.assert_array_equal(surface.face_colours, [GREY] * 2)
    for mesh in forms(red):
        np.testing.assert_array_equal(meshreaders.read(mesh).face_colours, [[255, 128, 0]] * 2)


def test_an_image_of_a_mesh_of_open3d_lies_where_that_of_its_file_does(tmp_path):
    open3d = load_open3d()
    text = SQUARE.replace("f 1/1 2/2 3/3 4/4", "f 1/1 2/2 3/3\nf 1/1 3/3 4/4")
    path = write_square(tmp_path, BOARD[:4], text=text)
    expected = meshreaders.read(path).texture
    found = meshreaders.read(
        open3d.io.read_triangle_mesh(str(path), enable_post_processing=True)
    ).texture
    np.testing.assert_array_equal(found.images[0], expected.images[0])
    np.testing.assert_allclose(
        np.sort(found.corners.reshape(-1, 2), axis=0),
        np.sort(expected.corners.reshape(-1, 2), axis=0),
    )


class FakeData(dict):
    active_scalars_name = None


def poly_data(points, faces, lines=(), cells=(), colours=(), strips=()):
    """Return a mesh of PyVista, or a stand-in where PyVista is not installed."""
    if find_spec("pyvista") is None:
        return SimpleNamespace(
            points=np.array(points), faces=np.array(faces), strips=np.array(strips),
            cell_data=FakeData(cells), point_data=FakeData(colours),
        )  # fmt: skip
    pyvista = import_module("pyvista")
    mesh = pyvista.PolyData(
        np.array(points, float), faces=faces if len(faces) else None,
        lines=lines if len(lines) else None, strips=strips if len(strips) else None,
    )  # fmt: skip
    for data, arrays in ((mesh.cell_data, cells), (mesh.point_data, colours)):
        for name, array in dict(arrays).items():
            data[name] = array
    return mesh


PIECES = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [2, 1, 0], [0, 4, 0], [9, 0, 0]]
WITH_TRIANGLE = [5, 0, 1, 2, 3, 4, 3, 1, 5, 2]


def test_polygons_of_pyvista_are_cut_and_keep_the_colours_of_their_cells():
    colours = np.array([[7, 7, 7], [1, 2, 3], [4, 5, 6]], np.uint8)
    mesh = meshreaders.read(
        poly_data(
            PIECES, WITH_TRIANGLE, lines=[2, 0, 1], cells={"heat": np.arange(3.0), "RGB": colours}
        )
    )
    assert mesh.face_areas[:3].sum() == pytest.approx(10)
    assert mesh.face_areas[3] == pytest.approx(10)
    np.testing.assert_array_equal(mesh.face_colours, [[1, 2, 3]] * 3 + [[4, 5, 6]])


def test_colours_of_points_of_pyvista_are_averaged_and_a_mesh_without_is_grey():
    colours = np.zeros((6, 4), np.uint8)
    colours[5] = 255
    mesh = meshreaders.read(poly_data(PIECES, WITH_TRIANGLE, colours={"RGBA": colours}))
    np.testing.assert_array_equal(mesh.face_colours, [[0, 0, 0]] * 3 + [[85, 85, 85]])
    plain = meshreaders.read(poly_data(PIECES, [3, 0, 1, 2]))
    np.testing.assert_array_equal(plain.face_colours, [GREY])


def test_strips_of_pyvista_are_refused_with_advice():
    with pytest.raises(MeshError, match=r"strips; `mesh\.triangulate\(\)`"):
        meshreaders.read(poly_data(PIECES, [], strips=[4, 0, 1, 2, 3]))


def test_a_mesh_of_this_package_is_a_source_and_stays_as_it_is():
    mesh = meshreaders.read((POINTS, FACES))
    assert meshreaders.read(mesh) is mesh
    with pytest.raises(MeshError, match="type Mesh"):
        meshreaders.read_parts(mesh)


@pytest.mark.parametrize("factor", [None, [0.5, 0.2, 0.05, 1]])
def test_a_gltf_has_the_same_colour_from_its_file_and_through_trimesh(factor):
    file = Gltf()
    material = {} if factor is None else {"pbrMetallicRoughness": {"baseColorFactor": factor}}
    file.show({"mesh": file.mesh(material=file.add("materials", material))})
    compare_with_trimesh(file)


def test_vertex_colours_of_a_gltf_are_the_same_from_its_file_and_through_trimesh():
    file = Gltf()
    colours = file.put(
        np.float32([[0.5, 0.2, 0.05], [0.5, 0.2, 1.0], [0.0, 0.2, 0.05], *[[0.3, 0.4, 0.5]] * 5])
    )
    file.show({"mesh": file.mesh(attributes={"COLOR_0": colours})})
    compare_with_trimesh(file)


def compare_with_trimesh(file):
    data = file.binary()
    through = trimesh.load_scene(io.BytesIO(data), file_type="glb")
    found, wanted = (
        mesh.face_colours.astype(int)
        for mesh in (meshreaders.read(through), meshreaders.read(io.BytesIO(data), "glb"))
    )
    # trimesh keeps a byte of light, which in the dark is up to two steps of sRGB.
    np.testing.assert_allclose(found, wanted, atol=2)


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
        meshreaders.read(source)
