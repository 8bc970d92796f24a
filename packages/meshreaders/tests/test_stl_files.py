"""STL files are read as programs write them: text of any layout, colours in two ways, several solids."""

import io

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

import meshreaders
from meshreaders.base.errors import MeshError
from meshreaders.companions import Companions
from meshreaders.formats.stl_files import read_stl
from meshreaders.parts import GREY

TRIANGLES = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 1], [1, 0, 1], [0, 1, 1]]], float)


def read(data):
    return meshreaders.read(io.BytesIO(data), "stl")


def text(triangles=TRIANGLES, name="part"):
    faces = "".join(
        "facet normal 0 0 1\n outer loop\n"
        + "".join("  vertex {!r} {!r} {!r}\n".format(*map(float, corner)) for corner in triangle)
        + " endloop\nendfacet\n"
        for triangle in triangles
    )
    return f"solid {name}\n{faces}endsolid {name}\n"


def binary(triangles=TRIANGLES, attributes=(0, 0), header=b""):
    rows = np.zeros(
        len(triangles), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]
    )
    rows["corners"], rows["attribute"] = triangles, attributes
    return header.ljust(80, b"\0") + len(rows).to_bytes(4, "little") + rows.tobytes()


LAYOUTS = {
    "lines": text(),
    "one line": text().replace("\n", " "),
    "one line without names": text(name="").replace("\n", " "),
    "old mac": text().replace("\n", "\r"),
    "windows": text().replace("\n", "\r\n"),
    "tabs": text().replace(" ", "\t"),
    "capitals": text().upper(),
    "a word a line": text(name="a").replace(" ", "\n").replace("solid\na", "solid a"),
    "solids after one another": text(TRIANGLES[:1]) + text(TRIANGLES[1:], "other"),
    "solids on one line": (text(TRIANGLES[:1]) + text(TRIANGLES[1:], "other")).replace("\n", " "),
    "names of words": text(name="vertex 1 2 3 of a solid facet"),
    "latin-1 name": text(name="teil_é").encode("latin-1"),
    "blank lines and no last line end": text().replace("\n", "\n\n").rstrip(),
    "byte order mark": "\ufeff" + text(),
}


@pytest.mark.parametrize(
    ("behind", "count"),
    [
        (b"\0", "1 byte"),
        (b"made by hand", "12 bytes"),
        (bytes(50), "50 bytes"),
        (bytes(512 - 184), "328 bytes"),
        (binary(), "184 bytes"),
    ],
)
def test_bytes_behind_the_last_face_are_noted(behind, count):
    companions = Companions()
    (part,) = read_stl(binary() + behind, companions)
    np.testing.assert_array_equal(part.vertices.reshape(-1, 3, 3), TRIANGLES)
    assert companions.notes == [f"goes on for {count} behind its last face; that part is not read"]


@pytest.mark.parametrize("layout", LAYOUTS)
def test_white_space_of_any_kind_parts_words(layout):
    data = LAYOUTS[layout]
    surface = read(data if isinstance(data, bytes) else data.encode())
    np.testing.assert_array_equal(surface.triangles, TRIANGLES)
    np.testing.assert_array_equal(surface.face_colours, [GREY] * 2)


def test_a_binary_file_whose_header_begins_with_solid_is_binary():
    np.testing.assert_array_equal(read(binary(header=b"solid facet vertex")).triangles, TRIANGLES)


RED, BLUE = 31, 31 << 10
MAGICS = b"COLOR=" + bytes([10, 20, 30, 255])


@pytest.mark.parametrize(
    ("header", "attributes", "expected"),
    [
        (b"", (0, 0), [GREY, GREY]),
        (b"", (7, RED), [GREY, GREY]),
        (b"", (1 << 15 | BLUE, 1 << 15), [[255, 0, 0], [0, 0, 0]]),
        (b"", (1 << 15 | RED, 0), [[0, 0, 255], GREY]),
        (MAGICS, (RED, BLUE), [[255, 0, 0], [0, 0, 255]]),
        (MAGICS, (RED, 1 << 15 | BLUE), [[255, 0, 0], [10, 20, 30]]),
        (MAGICS, (0, 0), [[10, 20, 30]] * 2),
        (b"exported by a program " + MAGICS, (16 << 5, 1 << 15), [[0, 132, 0], [10, 20, 30]]),
    ],
)
def test_colours_are_read_as_viscam_and_magics_write_them(header, attributes, expected):
    surface = read(binary(attributes=attributes, header=header))
    np.testing.assert_array_equal(surface.face_colours, expected)


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (
            text().replace("vertex 1.0", "vertex 1,0").encode(),
            "face 1 holds '1,0', .* decimal points",
        ),
        (text().replace("vertex 1.0 0.0 1.0", "vertex 1.0 x 1.0").encode(), "face 2 holds 'x'"),
        (
            text().replace("  vertex 0.0 1.0 1.0\n", "").encode(),
            "2 faces, which need 6 corners, .* 5 corners",
        ),
        (text().rpartition("endsolid")[0].encode(), "no end of the last solid"),
        (text().rpartition("endfacet")[0].encode(), "1 ends of faces"),
        (binary()[:-1], "truncated: its header promises 2 faces, hence 184 bytes, and 183"),
        (b"hello", "truncated"),
        (b"solid empty\nendsolid empty\n", "it has no faces; triangles"),
        (
            text().replace(" endloop", " vertex 9 9 9\n endloop", 1).encode(),
            "STL: a face has more than 3 corners: it has 2 faces, which need 6 corners, .* 7 corners",
        ),
        (binary() + binary()[-50:], "holds too much: its header promises 2 faces"),
        (binary(TRIANGLES[:0], ()) + b"a", "holds too much: its header promises 0 faces"),
        (b"PK\3\4" + binary()[4:] + b"a", "its content is a ZIP archive"),
    ],
)
def test_what_is_cut_or_no_number_is_refused_with_the_place(data, says):
    with pytest.raises(MeshError, match=says):
        read(data)


@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["stl", "stl_ascii"]))
def test_any_mesh_is_the_one_that_trimesh_wrote(seed, kind):
    random = np.random.default_rng(seed)
    mesh = trimesh.creation.random_soup(int(random.integers(1, 30)))
    mesh.apply_scale(10.0 ** random.integers(-2, 4))
    data = mesh.export(file_type=kind)
    surface = read(data.encode() if isinstance(data, str) else data)
    np.testing.assert_allclose(surface.triangles, mesh.triangles, rtol=1e-6, atol=1e-6 * mesh.scale)
    assert surface.face_areas.sum() == pytest.approx(mesh.area, rel=1e-5)
