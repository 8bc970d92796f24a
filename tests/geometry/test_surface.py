"""A surface knows its areas and normals, and its file gives it back."""

from dataclasses import replace

import numpy as np
import pytest
from numerics.surfaces import build_plain_surface

from meshreaders.base.texture import CLAMP, MIRROR, NO_IMAGE, REPEAT, Texture
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.surface import (
    Surface,
    as_stored,
    notes_of,
    read_surface,
    set_aside_reason,
    usable_meshes,
    write_set_aside,
    write_surface,
)


@pytest.fixture
def tetrahedron():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    return Surface(vertices, faces, np.arange(12, dtype=np.uint8).reshape(4, 3))


def test_areas_and_normals_of_a_tetrahedron(tetrahedron):
    np.testing.assert_allclose(tetrahedron.face_areas, [0.5, 0.5, 0.5, np.sqrt(3) / 2])
    expected = [[0, 0, -1], [0, -1, 0], [-1, 0, 0], np.ones(3) / np.sqrt(3)]
    np.testing.assert_allclose(tetrahedron.face_normals, expected, atol=1e-15)


def test_a_face_without_area_has_a_zero_normal_and_no_nan():
    line = build_plain_surface([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]])
    np.testing.assert_array_equal(line.face_normals, 0)


def test_another_file_and_one_that_is_cut_are_refused_by_name(tetrahedron, painted, tmp_path):
    path = tmp_path / "broken.ply"
    contents = [b"", b"ply\n", b"not a mesh", bytes(range(256))]
    for surface, missing in ((tetrahedron, 5), (painted, 1)):
        write_surface(surface, path)
        contents.append(path.read_bytes()[:-missing])
    for content in contents:
        path.write_bytes(content)
        with pytest.raises(MeshError, match=r"broken\.ply is no coloured triangle mesh"):
            read_surface(path)


def test_a_packed_file_with_a_damaged_middle_is_refused_by_name(tetrahedron, tmp_path):
    path = tmp_path / "a.ply.gz"
    write_surface(tetrahedron, path)
    packed = bytearray(path.read_bytes())
    for place in range(10, len(packed) - 8):
        damaged = packed.copy()
        damaged[place] ^= 0xFF
        path.write_bytes(damaged)
        with pytest.raises(MeshError, match=r"a\.ply\.gz is no coloured triangle mesh"):
            read_surface(path)


def test_an_object_that_is_set_aside_says_why_and_is_not_usable(tetrahedron, tmp_path):
    path = tmp_path / "x" / "broken.ply"
    reason = "meshes/own/Tasse/Käse\n.obj has no faces; <triangles> are needed."
    write_set_aside(path, reason)
    assert set_aside_reason(path) == reason
    assert len(read_surface(path).faces) == 0
    write_surface(tetrahedron, tmp_path / "a.ply")
    assert usable_meshes([path, tmp_path / "a.ply"]) == [tmp_path / "a.ply"]


def test_notes_stay_with_the_surface_in_its_file_and_are_read_without_it(tetrahedron, tmp_path):
    notes = ("a.obj refers to 'käse\n.mtl'.", "end_header")
    write_surface(tetrahedron, tmp_path / "plain.ply")
    for name in ("noted.ply", "noted.ply.gz"):
        write_surface(replace(tetrahedron, notes=notes), tmp_path / name)
        found = read_surface(tmp_path / name)
        assert found.notes == notes
        np.testing.assert_array_equal(found.vertices, tetrahedron.vertices)
    assert notes_of(tmp_path / "noted.ply") == list(notes)
    assert notes_of(tmp_path / "plain.ply") == []
    assert set_aside_reason(tmp_path / "noted.ply") is None


@pytest.fixture
def painted(tetrahedron):
    generator = np.random.default_rng(0)
    images = tuple(
        generator.integers(0, 256, (*size, 3), dtype=np.uint8) for size in ((3, 5), (1, 1), (8, 2))
    )
    corners = generator.normal(size=(4, 3, 2)).astype(np.float32)
    wraps = np.array([[REPEAT, CLAMP], [MIRROR, MIRROR], [CLAMP, REPEAT]], dtype=np.uint8)
    texture = Texture(corners, np.array([2, NO_IMAGE, 0, 1], np.int32), images, wraps)
    return replace(tetrahedron, texture=texture)


@pytest.mark.parametrize("name", ["a.ply", "deep/a.ply.gz"])
@pytest.mark.parametrize("shape", ["tetrahedron", "painted"])
def test_a_file_gives_the_surface_back_and_the_same_bytes(request, tmp_path, name, shape):
    given = request.getfixturevalue(shape)
    write_surface(given, tmp_path / name)
    back = read_surface(tmp_path / name)
    for field in ("vertices", "faces", "face_colours"):
        np.testing.assert_array_equal(getattr(back, field), getattr(given, field))
    assert as_stored(given).texture is given.texture
    assert (back.texture is None) == (given.texture is None)
    if given.texture is not None:
        for field in ("corners", "image", "wraps"):
            found, expected = getattr(back.texture, field), getattr(given.texture, field)
            np.testing.assert_array_equal(found, expected)
        for one, other in zip(back.texture.images, given.texture.images, strict=True):
            np.testing.assert_array_equal(one, other)
    written = (tmp_path / name).read_bytes()
    write_surface(back, tmp_path / name)
    assert (tmp_path / name).read_bytes() == written


def test_other_tools_read_a_file_with_images_or_without_as_one_with_colours(
    painted, tetrahedron, tmp_path
):
    import trimesh

    from visuohaptic.geometry.compiled_open3d import open3d

    for surface in (painted, tetrahedron):
        write_surface(surface, tmp_path / "a.ply")
        mesh = trimesh.load_mesh(tmp_path / "a.ply", process=False)
        np.testing.assert_array_equal(mesh.faces, surface.faces)
        np.testing.assert_array_equal(mesh.visual.face_colors[:, :3], surface.face_colours)
        other = open3d.io.read_triangle_mesh(str(tmp_path / "a.ply"))
        np.testing.assert_array_equal(np.asarray(other.triangles), surface.faces)


def test_images_that_do_not_fit_are_refused_by_name(painted, tmp_path):
    path, good = tmp_path / "a.ply", painted.texture
    for bad, says in (
        ({"image": good.image + np.int32(1)}, "an image index outside of -1 to 2"),
        ({"image": good.image - np.int32(1)}, "an image index outside of -1 to 2"),
        ({"wraps": good.wraps + np.uint8(1)}, "a wrap is above 2"),
        ({"corners": good.corners * np.inf}, "coordinate is not finite"),
    ):
        write_surface(replace(painted, texture=replace(good, **bad)), path)
        with pytest.raises(MeshError, match=rf"a\.ply is no coloured triangle mesh.*{says}"):
            read_surface(path)
    write_surface(painted, path)
    data = path.read_bytes()
    first = np.array([5, 3], "<i4").tobytes()
    for size in ((6, 3), (5, 0), (-5, 3), (2**31 - 1, 3)):
        path.write_bytes(data.replace(first, np.array(size, "<i4").tobytes(), 1))
        with pytest.raises(MeshError, match=r"a\.ply is no coloured triangle mesh"):
            read_surface(path)
