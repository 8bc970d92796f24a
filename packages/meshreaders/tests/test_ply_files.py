"""PLY files are read as those who wrote them meant them: colours of all names, images, strips, any header."""

import io
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mesh_files import generated
from mesh_files.generated import BOARD
from PIL import Image
from plyfile import PlyData, PlyElement

import meshreaders
from meshreaders.base.errors import MeshError
from meshreaders.parts import GREY

SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
HALVES = [[0, 1, 2], [0, 2, 3]]
RED = (200, 30, 10)


def read(data):
    return meshreaders.read(io.BytesIO(data if isinstance(data, bytes) else data.encode()), "ply")


def text(vertex, face, rows, comments=(), extra=""):
    """A PLY text of four vertices and two triangles with further properties."""
    head = ["ply", "format ascii 1.0", *(f"comment {one}" for one in comments), "element vertex 4"]
    head += [f"property float {axis}" for axis in "xyz"] + [f"property {one}" for one in vertex]
    head += ["element face 2", "property list uchar int vertex_indices"]
    head += [f"property {one}" for one in face]
    return "\n".join([*head, *([extra] if extra else []), "end_header", *rows, ""])


def rows(of_vertices=("", "", "", ""), of_faces=("", "")):
    points = [f"{x} {y} {z} {more}" for (x, y, z), more in zip(SQUARE, of_vertices, strict=True)]
    return points + [
        f"3 {a} {b} {c} {more}" for (a, b, c), more in zip(HALVES, of_faces, strict=True)
    ]


@pytest.mark.parametrize(
    "kind", ["uchar", "int", "float", "share", "double", "ushort", "ushort 255"]
)
@pytest.mark.parametrize(
    "names", ["red green blue", "diffuse_red diffuse_green diffuse_blue", "r g b"]
)
@pytest.mark.parametrize("element", ["vertex", "face"])
def test_colours_of_any_name_and_range_are_the_same(kind, names, element):
    factor = {"share": 1 / 255, "ushort": 257}.get(kind, 1)
    numbers = " ".join(f"{channel * factor:.9g}" for channel in RED)
    named = {"share": "float", "ushort 255": "ushort"}.get(kind, kind)
    properties = [f"{named} {name}" for name in names.split()]
    if element == "vertex":
        data = text(properties, [], rows(of_vertices=[numbers] * 4))
    else:
        data = text([], properties, rows(of_faces=[numbers, "0 0 0"]))
    colours = read(data).face_colours
    np.testing.assert_array_equal(colours[0], RED)
    np.testing.assert_array_equal(colours[1], RED if element == "vertex" else 0)


def test_materials_give_their_colours_to_the_faces_that_name_them():
    extra = "element material 1\n" + "\n".join(
        f"property uchar diffuse_{one}" for one in ("red", "green", "blue")
    )
    data = text([], ["int material_index"], [*rows(of_faces=["0", "-1"]), "200 30 10"], extra=extra)
    np.testing.assert_array_equal(read(data).face_colours, [RED, GREY])


@pytest.mark.parametrize("names", ["s t", "u v", "texture_u texture_v"])
def test_coordinates_on_an_image_are_read_from_vertices(tmp_path, names):
    Image.fromarray(BOARD).save(tmp_path / "my board.png")
    places = [f"{x} {y}" for x, y, _ in SQUARE]
    properties = [f"float {name}" for name in names.split()]
    (tmp_path / "a.ply").write_text(
        text(properties, [], rows(places), ["TextureFile my board.png"])
    )
    surface = meshreaders.read(tmp_path / "a.ply")
    np.testing.assert_array_equal(surface.texture.images[0], BOARD)
    np.testing.assert_array_equal(surface.texture.corners, np.array(SQUARE)[HALVES][..., :2])


def test_each_face_has_the_image_of_its_number_or_none(tmp_path):
    for name, colour in (("a.png", RED), ("b.png", (9, 200, 9))):
        Image.new("RGB", (2, 2), colour).save(tmp_path / name)
    properties = ["list uchar float texcoord", "int texnumber"]
    comments = ["TextureFile a.png", "TextureFile b.png"]
    for ends, expected in (
        (["6 0 0 1 0 1 1 1", "6 0 0 1 1 0 1 0"], [(9, 200, 9), RED]),
        (["6 0 0 1 0 1 1 0", "6 0 0 1 1 0 1 -1"], [RED, GREY]),
        (["6 0 0 1 0 1 1 0", "0 1"], [RED, GREY]),
        (["6 0 0 1 0 1 1 0", "6 0 0 1 1 0 1 7"], [RED, GREY]),
    ):
        (tmp_path / "a.ply").write_text(text([], properties, rows(of_faces=ends), comments))
        surface = meshreaders.read(tmp_path / "a.ply")
        order = np.argsort(
            surface.triangles[:, 1, 1]
        )  # the first triangle has its second corner at y = 0
        assert [tuple(colour) for colour in surface.face_colours[order]] == expected


def test_an_image_that_is_missing_or_has_no_coordinates_is_said(tmp_path):
    (tmp_path / "a.ply").write_text(
        text(["float s", "float t"], [], rows(["0 0"] * 4), ["TextureFile gone.png"])
    )
    (note,) = meshreaders.read(tmp_path / "a.ply").notes
    assert "a.ply refers to 'gone.png', which is not there" in note
    (tmp_path / "a.ply").write_text(text([], [], rows(), ["TextureFile gone.png"]))
    (note,) = meshreaders.read(tmp_path / "a.ply").notes
    assert "names an image and has no image coordinates" in note


def test_strips_alternate_their_winding_and_end_at_minus_one():
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 2, 0], [1, 2, 0]]
    head = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element tristrips 2\nproperty list int int vertex_indices\nend_header\n"
    written = head + "".join(f"{x} {y} {z}\n" for x, y, z in points)
    surface = read(written + "7 0 1 2 3 -1 2 3\n4 2 3 4 5\n")
    assert surface.face_areas.sum() == pytest.approx(2)
    np.testing.assert_allclose(surface.face_normals, [[0, 0, 1]] * 4)
    # A vertex twice in a row turns the strip; its faces have no area.
    assert read(written + "5 0 1 2 3 3\n2 0 1\n").face_areas.tolist() == [0.5, 0.5]
    with pytest.raises(MeshError, match="names vertex 9; 0 to 5"):
        read(written + "3 0 1 9\n3 0 1 2\n")


HEADERS = {
    "utf-8 comment": lambda data: data.replace(b"format", "comment José\nformat".encode(), 1),
    "latin-1 comment": lambda data: data.replace(
        b"format", "comment José\nformat".encode("latin-1"), 1
    ),
    "obj_info": lambda data: data.replace(b"format", b"obj_info num_cols 512\nformat", 1),
    "blanks": lambda data: data.replace(b"element vertex", b"element   vertex", 1).replace(
        b"double x\n", b"double x \n"
    ),
    "windows": lambda data: (
        data[: data.index(b"end_header\n")].replace(b"\n", b"\r\n")
        + b"end_header\r\n"
        + data.partition(b"end_header\n")[2]
    ),
    "old mac": lambda data: (
        data[: data.index(b"end_header\n")].replace(b"\n", b"\r")
        + b"end_header\r"
        + data.partition(b"end_header\n")[2]
    ),
    "bytes behind": lambda data: data + b"\0 \n more of 100 things",
}


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
@pytest.mark.parametrize("name", HEADERS)
def test_a_header_may_be_written_in_any_way(name, form):
    data = HEADERS[name](generated.as_ply(SQUARE, HALVES, form))
    if form == "ascii" and name == "bytes behind":
        data = data.replace(b"\0", b"")
    np.testing.assert_array_equal(read(data).triangles, np.array(SQUARE)[HALVES])


def test_text_whose_lines_end_in_carriage_returns_only_is_read():
    data = generated.as_ply(SQUARE, HALVES, "ascii").replace(b"\n", b"\r")
    np.testing.assert_array_equal(read(data).triangles, np.array(SQUARE)[HALVES])


def test_further_lists_and_elements_are_passed_over():
    vertex = np.array([tuple(point) for point in SQUARE], [(axis, "f4") for axis in "xyz"])
    face = np.empty(2, [("flags", "O"), ("vertex_index", "O"), ("label", "u1")])
    face["flags"], face["label"] = [[], [7, 8, 9]], [1, 2]
    face["vertex_index"] = HALVES
    camera = np.array([(1.0,)], [("fov", "f4")])
    elements = [
        PlyElement.describe(one, name)
        for one, name in ((vertex, "vertex"), (face, "face"), (camera, "camera"))
    ]
    for order in ((0, 1, 2), (2, 0, 1)):
        for options in ({"text": True}, {"byte_order": "<"}, {"byte_order": ">"}):
            stream = io.BytesIO()
            PlyData([elements[place] for place in order], **options).write(stream)
            np.testing.assert_array_equal(
                read(stream.getvalue()).triangles, np.array(SQUARE)[HALVES]
            )


@st.composite
def coloured_polygons(draw):
    """Flat polygons apart from one another, each of one colour, and the triangles' sums."""
    seed, count = draw(st.integers(0, 2**32 - 1)), draw(st.integers(1, 6))
    random = np.random.default_rng(seed)
    points, faces, colours, area = [], [], [], 0.0
    for number in range(count):
        outline = generated.star(random, int(random.integers(3, 9)))
        x, y = outline.T
        area += 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
        faces.append([len(points) + corner for corner in range(len(outline))])
        points += [[*map(float, corner), 3.0 * number] for corner in outline]
        colours.append(random.integers(0, 256, 3).tolist())
    return points, faces, colours, area


@settings(max_examples=40)
@given(coloured_polygons(), st.sampled_from(["ascii", "<", ">"]), st.booleans())
def test_any_coloured_polygons_are_those_that_plyfile_wrote(mesh, form, of_vertices):
    points, faces, colours, area = mesh
    channels = [("red", "u1"), ("green", "u1"), ("blue", "u1")]
    owner = [number for number, face in enumerate(faces) for _ in face]
    rows_of = lambda numbers: [tuple(colours[number]) for number in numbers]  # noqa: E731
    vertex = np.array(
        [(*point, *more) for point, more in zip(points, rows_of(owner), strict=True)],
        [
            *((axis, "f8") for axis in "xyz"),
            *(channels if of_vertices else [(f"q{k}", "u1") for k in range(3)]),
        ],
    )
    face = np.empty(len(faces), [("vertex_indices", "O"), *channels])
    face["vertex_indices"] = faces
    for channel, (name, _) in enumerate(channels):
        face[name] = [colour[channel] for colour in colours]
    stream = io.BytesIO()
    options = {"text": True} if form == "ascii" else {"byte_order": form}
    PlyData(
        [PlyElement.describe(vertex, "vertex"), PlyElement.describe(face, "face")], **options
    ).write(stream)
    surface = read(stream.getvalue())
    assert surface.face_areas.sum() == pytest.approx(area, rel=1e-9)
    np.testing.assert_allclose(np.ptp(surface.vertices, axis=0), np.ptp(points, axis=0))
    number = np.rint(surface.triangles[:, 0, 2] / 3).astype(int)
    np.testing.assert_array_equal(surface.face_colours, np.array(colours)[number])


@pytest.mark.filterwarnings("error:loadtxt")
@pytest.mark.parametrize(
    ("data", "says"),
    [
        (text([], [], rows()).replace("1 1 0", "1 1-2 0"), "row 2: property 'y': malformed"),
        (
            text([], [], rows()).replace("3 0 1 2 \n3 0", "3 0 1 \n2 3 0"),
            "'face', and 0 are complete",
        ),
        (text([], [], rows()).replace("float x", "float a"), "no numbers x, y and z"),
        (
            text([], [], rows())
            .replace("uchar int", "uchar float")
            .replace("3 0 1 2", "3 0 1 2.5"),
            "names vertex 2.5; whole numbers",
        ),
        (
            text([], [], rows()).replace("1 0 0 ", "1,0 0 0 "),
            "'vertex': row 1: property 'x': malformed",
        ),
        (
            text([], ["list uchar uchar tags"], rows(of_faces=["0", "0"])).replace(
                "3 0 1 2", "3 0 1 7"
            ),
            "names vertex 7",
        ),
    ],
)
def test_what_is_no_mesh_is_refused_by_its_place(data, says):
    with pytest.raises(MeshError, match=says):
        read(data)


def test_a_truncated_list_is_named_by_its_row():
    data = generated.as_ply(SQUARE, [[0, 1, 2, 3], [0, 1, 2]])
    with pytest.raises(MeshError, match="2 rows of 'face', and 1 are complete"):
        read(data[:-3])
    assert struct.calcsize("<B3i") == 13
