"""OFF files are read as Geomview and its users write them: any white space, and colours of vertices and faces."""

import io

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mesh_files import generated

import meshreaders
from meshreaders.base.errors import MeshError
from meshreaders.parts import GREY

POINTS = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
FACES = [[0, 1, 2], [0, 2, 3]]
ROWS = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"]
RED = [200, 30, 10]


def read(text):
    return meshreaders.read(io.BytesIO(text.encode()), "off")


def off(keyword="OFF", counts="\n4 2 0", of_vertices="", ends=("", "")):
    rows = [f"{row} {of_vertices}" for row in ROWS]
    return "\n".join([f"{keyword}{counts}", *rows, f"3 0 1 2 {ends[0]}", f"3 0 2 3 {ends[1]}", ""])


LAYOUTS = {
    "as Geomview writes": off(),
    "counts beside the keyword": off(counts=" 4 2 5"),
    "counts glued to the keyword": off(counts="4 2 0"),
    "no number of edges": off(counts="\n4 2"),
    "counts a line each": off(counts="\n4\n2\n0"),
    "no keyword": off("", "4 2 0"),
    "small letters": off("off"),
    "comments and empty lines": off().replace("\n", " # 7 7\n\n# a comment\n"),
    "vertices on one line": "OFF\n4 2 0\n" + " ".join(ROWS) + "\n3 0 1 2\n3 0 2 3\n",
    "two vertices a line": "OFF\n4 2 0\n0 0 0 1 0 0\n1 1 0 0 1 0\n3 0 1 2\n3 0 2 3\n",
    "all on one line": "OFF 4 2 0 " + " ".join(ROWS) + " 3 0 1 2 3 0 2 3",
    "a number a line": off().replace(" ", "\n").replace("\n\n", "\n"),
    "faces on one line": "OFF\n4 2 0\n" + "\n".join(ROWS) + "\n3 0 1 2 3 0 2 3\n",
    "windows": off().replace("\n", "\r\n"),
    "old mac": off().replace("\n", "\r"),
    "tabs": off().replace(" ", "\t"),
    "normals": off("NOFF", of_vertices="0 0 1"),
    "coordinates on an image": off("STOFF", of_vertices="0.5 0.25"),
    "no last line end": off().rstrip("\n"),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_white_space_of_any_kind_parts_numbers(layout):
    surface = read(LAYOUTS[layout])
    np.testing.assert_array_equal(surface.triangles, np.array(POINTS)[FACES])
    np.testing.assert_array_equal(surface.face_colours, [GREY] * 2)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (off("COFF", of_vertices="200 30 10 255"), [RED, RED]),
        (off("COFF", of_vertices="200 30 10"), [RED, RED]),
        (off("COFF", of_vertices="1 0.5 0 1"), [[255, 128, 0]] * 2),
        (off("CNOFF", of_vertices="0 0 1 200 30 10 255"), [RED, RED]),
        (off("STCOFF", of_vertices="200 30 10 255 0.5 0.5"), [RED, RED]),
        (off("OFF", of_vertices="200 30 10 255"), [RED, RED]),
        (off("OFF", of_vertices="0 0 -1"), [GREY, GREY]),
        (off("OFF", of_vertices="0.6 0.8 0"), [GREY, GREY]),
        (off(ends=("200 30 10", "0 0 0")), [RED, [0, 0, 0]]),
        (off(ends=("200 30 10 255", "")), [RED, GREY]),
        (off(ends=("1.0 0.5 0", "0 0 0")), [[255, 128, 0], [0, 0, 0]]),
        (off(ends=("5", "7")), [GREY, GREY]),
        (off("COFF", of_vertices="200 30 10 255", ends=("1 2 3", "")), [[1, 2, 3], RED]),
    ],
)
def test_colours_of_vertices_and_faces_are_read(text, expected):
    np.testing.assert_array_equal(read(text).face_colours, expected)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (
            off().replace("1 1 0", "1,5 1 0"),
            r"line 5 holds '1,5', which is no number; decimal points",
        ),
        (off().replace("1 1 0", "1 one 0"), "line 5 holds 'one'"),
        (off().replace("1 1 0", "1 1-2 0"), "line 5 holds '1-2'"),
        (off().replace("3 0 1 2", "3 0 1 2.5"), "a face holds 2.5; whole numbers"),
        (off().replace("3 0 1 2", "-3 0 1 2"), "face 0 promises -3 corners"),
        (off().replace("3 0 1 2", "nan 0 1 2"), "a face holds nan"),
        (off("4OFF", of_vertices="1"), "4 dimensions"),
        ("OFF BINARY\n" + off(), "binary OFF"),
        (off(counts="\n4"), "truncated|promise"),
        ("OFF\n", "have the numbers of vertices"),
        (off(counts="\n4 9 0"), "truncated: .* 9 faces"),
        (off(counts="\n9 2 0"), "truncated: .* 9 vertices|names vertex"),
    ],
)
def test_what_is_no_off_is_refused_with_the_place(text, says):
    with pytest.raises(MeshError, match=says):
        read(text)


@pytest.mark.parametrize("whole_lines", [0, 9_000])
@pytest.mark.parametrize("most", [1, 7, 10**6])
def test_lines_may_break_anywhere_in_a_file_of_many_blocks(most, whole_lines):
    random = np.random.default_rng(most)
    points = random.normal(size=(9_000, 3))
    counts = [3, *random.integers(3, 5, 29_998), 3]
    faces = [random.integers(0, 9_000, count) for count in counts]
    text = generated.as_off(points, faces).decode()
    head, *rows = text.split("\n")[1:]
    words = " ".join(rows[whole_lines:]).split()
    ends = np.cumsum(random.integers(1, most + 1, len(words)))
    lines = [" ".join(line) for line in np.split(words, ends[ends < len(words)])]
    wrapped = read("\n".join(["OFF", head, *rows[:whole_lines], *lines, ""]))
    np.testing.assert_array_equal(wrapped.triangles, read(text).triangles)
    np.testing.assert_array_equal(wrapped.triangles[[0, -1]], points[[faces[0], faces[-1]]])


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1), st.booleans(), st.booleans())
def test_any_prism_with_any_colours_is_the_one_that_was_written(seed, of_vertices, of_faces):
    points, faces, area, volume = generated.random_prism(seed)
    random = np.random.default_rng(seed)
    colours = random.integers(2, 256, (len(faces), 3))
    rows = ["{!r} {!r} {!r}".format(*map(float, point)) for point in points]
    if of_vertices:
        rows = [f"{row} 9 8 7 255" for row in rows]
    ends = [" ".join(map(str, [len(face), *face])) for face in faces]
    if of_faces:
        ends = [
            f"{end} {red} {green} {blue}"
            for end, (red, green, blue) in zip(ends, colours, strict=True)
        ]
    keyword = "COFF" if of_vertices else "OFF"
    surface = read("\n".join([keyword, f"{len(points)} {len(faces)} 0", *rows, *ends, ""]))
    assert surface.face_areas.sum() == pytest.approx(area, rel=1e-9)
    assert np.linalg.det(surface.triangles).sum() / 6 == pytest.approx(volume, rel=1e-9)
    np.testing.assert_allclose(np.ptp(surface.vertices, axis=0), np.ptp(points, axis=0))
    expected = np.repeat(colours, [len(face) - 2 for face in faces], axis=0)
    others = [9, 8, 7] if of_vertices else GREY
    np.testing.assert_array_equal(
        surface.face_colours, expected if of_faces else np.tile(others, (len(expected), 1))
    )
