"""An OBJ file is read as those who wrote it meant it: shape, colours, images, and what is wrong in it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mesh_files.generated import BOARD
from PIL import Image

from meshreaders.base.errors import MeshError
from meshreaders.companions import Companions, FolderCompanions
from meshreaders.formats.obj_files import read_obj
from meshreaders.parts import GREY, join_parts

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
SIDES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
VERTICES = "".join(f"v {x} {y} {z}\n" for x, y, z in CUBE)
FACES = "".join(f"f {' '.join(str(corner + 1) for corner in side)}\n" for side in SIDES)
RED = "newmtl red\nKd 1 0 0\n"


def read(text, companions=None):
    data = text if isinstance(text, bytes) else text.encode()
    return join_parts(read_obj(data, companions or Companions()))


def read_in(folder, text, **files):
    """Read a cube after some text, with an MTL file `a.mtl` or others in its folder."""
    for name, content in files.items():
        path = folder / name.replace("_", ".")
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    companions = FolderCompanions(folder / "a.obj")
    return read(text, companions), companions


def area_and_volume(surface):
    return surface.face_areas.sum(), abs(np.linalg.det(surface.triangles).sum()) / 6


def colours_of(surface):
    return sorted(set(map(tuple, surface.face_colours.tolist())))


MARKED = VERTICES.replace("v 0 0 0", "v 0 0 0 # first").replace("v 1 1 1", "v 1 1 1# last")
WRITTEN = {
    "comments": f"# f 1 2 3\n{MARKED}  # indented\n{FACES}#",
    "comments behind faces": VERTICES + FACES.replace("\n", " # f 1 2 3\n"),
    "tabs and blanks": (VERTICES + FACES).replace(" ", " \t ").replace("\n", " \n\t"),
    "Windows": (VERTICES + FACES).replace("\n", "\r\n"),
    "old Mac": (VERTICES + FACES).replace("\n", "\r"),
    "Windows twice": (VERTICES + FACES).replace("\n", "\r\r\n"),
    "continued everywhere": (VERTICES + FACES).replace(" ", "\\\n"),
    "continued in Windows": (VERTICES + FACES).replace(" ", " \\ \r\n "),
    "a comment within a continued face": VERTICES + FACES.replace(" ", " \\\n# a folder\n", 1),
    "a comment that ends in a folder": f"# C:\\models\\\n{VERTICES}{FACES}",
    "upper case": (VERTICES + FACES).upper(),
    "faces first": FACES + VERTICES,
    "weights": VERTICES.replace("\n", " 1.0\n") + FACES,
    "groups": "o cube\ng a b\ns off\n" + VERTICES + "g\ns 1\n" + FACES,
    "lines and points": VERTICES + FACES + "l 1 2\np 3\nfoo bar\n",
    "corners with open slashes": VERTICES + FACES.replace(" 1 ", " 1// ").replace(" 4 ", " 4/ "),
    "byte order mark": "\ufeff" + VERTICES + FACES,
    "an unnamed vertex that is none": VERTICES + "v nan nan nan\nv -1.#IND 1.#QNAN00 -nan(ind)\n" + FACES,
    "an unnamed vertex far off": VERTICES + "v 1e9 1e9 1e9\n" + FACES,
    "faces of two corners": VERTICES + "f 1 2\nf 3\nf\n" + FACES,
    "plus signs": VERTICES.replace(" 1", " +1.0E+00") + FACES,
}  # fmt: skip


@pytest.mark.parametrize("name", WRITTEN)
def test_a_cube_is_a_cube_however_it_is_written(name):
    for encoding in ("utf-8", "utf-16"):
        surface = read(WRITTEN[name].encode(encoding))
        assert area_and_volume(surface) == pytest.approx((6, 1))
        assert len(surface.vertices) == 8


def test_corners_of_all_forms_stand_beside_each_other():
    forms = ["{0}", "{0}//1", "{0}/1", "{0}/1/1", "-{1}", "-{1}//-1"]
    text = f"{VERTICES}vt 0 0\nvn 0 0 1\n"
    for form, side in zip(forms, SIDES, strict=True):
        text += f"f {' '.join(form.format(corner + 1, 8 - corner) for corner in side)}\n"
    assert area_and_volume(read(text)) == pytest.approx((6, 1))


WRONG = {
    "v 1,0 0 0\n": "line 9: '1,0' is no number; numbers need a decimal point",
    "v 1 2\n": "line 9: a vertex has 2 coordinates; 3 are needed",
    "v 1 2 three\n": "line 9: 'three' is no number",
    "vt a 1\n": "line 9: 'a' is no number",
    "vt\n": "line 9: image coordinates have no number",
    "f 1 2 x\n": "line 9: 'x' is no whole number",
    "f 1 2 3.0\n": r"line 9: '3\.0' is no whole number",
    "f 1/1 2/1 3/y\n": "line 9: 'y' is no whole number",
    "f 1//1 2//1 3//z\n": "line 9: 'z' is no whole number",
    "f 1/1/1/1 2 3\n": "line 9: a corner of a face has more than 3 numbers",
    "f 1 2 99\n": "line 9: a face names vertex 99; 1 to 8 are there",
    "f 0 1 2\n": "line 9: a face names vertex 0; 1 to 8 are there",
    "f 1 2 -9\n": "line 9: a face names vertex 0; 1 to 8 are there",
    "f 1 2 99999999999\n": "line 9: a number is too large",
    "surf 0 1 0 1 1 2 3\n": "line 9: surf, a free-form surface, is not read",
    "call other.obj\n": "line 9: call, a call of another file, is not read",
    "f 1 2 \\\n\n3\n": "line 11: the line begins with the number '3'; a word is needed",
}  # fmt: skip


@pytest.mark.parametrize("line", WRONG)
def test_a_wrong_line_is_refused_by_its_number_and_word(line):
    with pytest.raises(MeshError, match=WRONG[line]):
        read(VERTICES + line + FACES)


def test_without_vertices_or_faces_it_is_refused():
    for text, says in (
        (VERTICES, "no faces"),
        (FACES, "names vertex 1; none is there"),
        ("", "no faces"),
    ):
        with pytest.raises(MeshError, match=says):
            read(text)


@pytest.mark.parametrize(
    ("columns", "colour"),
    [
        ("200 30 10", (200, 30, 10)),
        ("0.8 0.4 0.2", (204, 102, 51)),
        ("0.8 0.4 0.2 1.0", (204, 102, 51)),
        ("1.0 200 30 10", (200, 30, 10)),
        ("1 0.8 0.4 0.2", (204, 102, 51)),
        ("200 30 10 255", (200, 30, 10)),
        ("0.5 0.8 0.4 0.2", (128, 204, 102)),
        ("1 200 30 10 255", (200, 30, 10)),
        ("127.5 0 0", (128, 0, 0)),
        ("1 1 0", (255, 255, 0)),
        ("1.0000001 0 0", (255, 0, 0)),
        ("-0.5 0.1 0.9", GREY),
        ("300 0 0", GREY),
        ("1.4 0.2 0.2", GREY),
    ],
)
def test_vertex_colours_go_to_1_or_255_or_are_said_to_be_none(columns, colour):
    companions = Companions()
    surface = read(VERTICES.replace("\n", f" {columns}\n") + FACES, companions)
    assert colours_of(surface) == [colour]
    assert (companions.notes != []) == (colour == GREY)
    assert all("no colours" in note for note in companions.notes)


def test_faces_of_vertices_without_colours_are_grey_beside_others():
    for lines in (VERTICES.splitlines(), VERTICES.splitlines()[::-1]):
        mixed = [f"{line} 1 0 0" if " 0 0 " not in line else line for line in lines]
        coloured = "f 1 2 3\nf 6 7 8\n"
        surface = read("\n".join(mixed) + "\n" + coloured)
        assert set(colours_of(surface)) <= {GREY, (255, 0, 0)}
    some = "v 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nv 1 1 0 1 0 0\nv 9 9 9\nf 1 2 3\nf 2 3 4\n"
    assert read(some).face_colours.tolist() == [list(GREY), [255, 0, 0]]


def test_a_weight_that_is_not_the_same_at_all_vertices_is_a_red():
    text = "v 0 0 0 1 0 0 0.5\nv 1 0 0\nv 1 0 0 1 0 0 0.5\nv 0 1 0 {} 0 0 0.5\nf 1 3 4\nf 1 2 3\n"
    assert read(text.format(1)).face_colours.tolist() == [[0, 0, 128], list(GREY)]
    assert read(text.format("0.4")).face_colours.tolist() == [[204, 0, 0], list(GREY)]


def test_vertex_colours_are_multiplied_by_the_material_and_not_by_black(tmp_path):
    text = VERTICES.replace("\n", " 0.5 1 0.25\n") + "usemtl red\n" + FACES
    for diffuse, colour in (("1 0.5 0", (128, 128, 0)), ("0 0 0", (128, 255, 64))):
        surface, _ = read_in(tmp_path, f"mtllib a.mtl\n{text}", a_mtl=f"newmtl red\nKd {diffuse}\n")
        assert colours_of(surface) == [colour]


USES = {
    "tab": "mtllib\ta.mtl\n{}usemtl\tred\n",
    "indented": "  mtllib a.mtl\n{}  usemtl red  \n",
    "comments": "mtllib a.mtl # library\n{}usemtl red # body\n",
    "word in a comment": "# the mtllib and usemtl blue\nmtllib a.mtl\n{}usemtl red\n",
    "several in a line": "mtllib gone.mtl a.mtl\n{}usemtl red\n",
    "several lines": "mtllib gone.mtl\nmtllib a.mtl\n{}usemtl red\n",
    "behind the faces' vertices": "{}mtllib a.mtl\nusemtl red\n",
    "case": "mtllib A.MTL\n{}usemtl RED\n",
    "quotes": 'mtllib "a.mtl"\n{}usemtl "red"\n',
    "upper case": "MTLLIB a.mtl\n{}USEMTL red\n",
    "backslash": "mtllib .\\a.mtl\n{}usemtl red\n",
    "continued": "mtllib \\\na.mtl\n{}usemtl \\\n red\n",
}


@pytest.mark.parametrize("name", USES)
def test_a_material_is_found_however_it_is_named(tmp_path, name):
    text = USES[name].format(VERTICES).replace("\n", "\r\n") + FACES
    surface, _ = read_in(tmp_path, text, a_mtl=RED)
    assert colours_of(surface) == [(255, 0, 0)]


NAMES = [
    ("Material #25", "Material #25"), ("my red  paint", "my red paint"), ("red", "red # the body"),
    ("red # body", "red # another"), ("grün", "grün"), ("gru\u0308n", "grün"), ("r#d", "r#d"),
]  # fmt: skip


@pytest.mark.parametrize(("used", "defined"), NAMES)
def test_names_of_materials_may_hold_signs_and_blanks(tmp_path, used, defined):
    other = "newmtl Material #1\nKd 0 1 0\nnewmtl other\nKd 0 0 1\n"
    text = f"mtllib a.mtl\n{VERTICES}usemtl {used}\n{FACES}"
    for encodings in (("utf-8", "utf-8"), ("latin-1", "latin-1"), ("utf-8", "latin-1")):
        try:
            data = text.encode(encodings[0])
        except UnicodeEncodeError:
            continue
        mtl = f"{other}newmtl {defined}\nKd 1 0 0\n".encode(encodings[1])
        surface, companions = read_in(tmp_path, data, a_mtl=mtl)
        assert colours_of(surface) == [(255, 0, 0)]
        assert companions.missing == []


def test_what_a_file_names_and_does_not_get_is_said(tmp_path):
    text = f"{VERTICES}usemtl red\n{FACES}"
    surface, companions = read_in(tmp_path, f"mtllib gone.mtl\n{text}")
    assert companions.missing == ["'gone.mtl', which is not there; put that file beside it"]
    assert colours_of(surface) == [GREY]
    _, companions = read_in(tmp_path, f"mtllib a.mtl\n{text}", a_mtl="newmtl blue\nKd 0 0 1\n")
    assert companions.missing == ["materials, 'red', which are in none of its libraries"]
    for empty in ("\n", "# Material Count: 0\n", "Kd 1 0 0\n", "a.png\n"):
        _, companions = read_in(tmp_path, f"mtllib a.mtl\n{text}", a_mtl=empty)
        assert companions.missing == ["materials, 'red', which are in none of its libraries"]
    _, companions = read_in(tmp_path, text)
    assert companions.notes == ["names materials, 'red', and no library of them (mtllib)"]
    _, companions = read_in(tmp_path, f"mtllib a.mtl\n{text}", a_mtl=f"{RED}map_Kd gone.png\n")
    assert [one.split(",")[0] for one in companions.missing] == ["'gone.png'"]


def test_what_is_passed_over_is_said():
    companions = Companions()
    read(f"{VERTICES}{FACES}l 1 2\nl 2 3\np 1\nfoo 1\nvn 0 0 1\ns off\n", companions)
    assert companions.notes == [
        "has 2 lines and 1 points, which have no surface",
        "has statements that are not known: 'foo' (line 18)",
    ]


def test_only_faces_whose_corners_have_image_coordinates_show_the_image(tmp_path):
    Image.fromarray(BOARD).save(tmp_path / "t.png")
    text = "mtllib a.mtl\nvt 0 0\nvt 1 0\nvt 1 1\n" + VERTICES + "usemtl red\n"
    text += "f 1/1 2/2 3/3\nf 1 2 5\nf 5/1 6/2 7/9\n"
    surface, companions = read_in(tmp_path, text, a_mtl="newmtl red\nKd 1 0 0\nmap_Kd t.png\n")
    assert surface.texture.textured.tolist() == [True, False, False]
    assert surface.face_colours[1:].tolist() == [[255, 0, 0]] * 2
    assert "line 16: 9; 3 are there" in companions.notes[0]


def test_parts_stand_in_the_opposite_order_of_their_materials():
    text = f"{VERTICES}usemtl a\nf 1 2 3\nusemtl b\nf 2 3 4\nusemtl a\nf 5 6 7\n"
    corners = read(text).triangles
    np.testing.assert_array_equal(corners, CUBE[[[1, 2, 3], [0, 1, 2], [4, 5, 6]]])


@st.composite
def models(draw):
    """A mesh of mixed polygons in several materials: text, area, volume, extent and face areas by colour."""
    random = np.random.default_rng(draw(st.integers(0, 2**32)))
    text, libraries, expected, areas, volume = [], [], {}, 0.0, 0.0
    points = []
    for solid in range(draw(st.integers(1, 4))):
        colour = tuple(random.integers(0, 256, 3).tolist())
        libraries.append(
            f"newmtl m {solid} # {solid}\n\tKd {' '.join(str(c / 255) for c in colour)}\n"
        )
        sides, height = draw(st.integers(3, 9)), random.uniform(0.5, 2)
        angles = 2 * np.pi * np.arange(sides) / sides
        ring = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(sides)])
        own = np.concatenate([ring, ring + np.array([0, 0, height])]) + random.uniform(-9, 9, 3)
        polygons = [list(range(sides))[::-1], list(range(sides, 2 * sides))]
        polygons += [[k, (k + 1) % sides, (k + 1) % sides + sides, k + sides] for k in range(sides)]
        text += ["v {!r} {!r} {!r}".format(*map(float, point)) for point in own]
        text += [draw(st.sampled_from([f"g solid{solid}", "s 1", "# usemtl x", "\tvn 0 0 1", ""]))]
        text += [f"usemtl m {solid} # {solid}"]
        for polygon in polygons:
            form = draw(st.sampled_from(["{0}", "{0}//1", "{1}", "{1}//-1"]))
            corners = [form.format(len(points) + k + 1, k - 2 * sides) for k in polygon]
            gap = draw(st.sampled_from([" ", "\t", "  ", " \\\n "]))
            text.append(f"f{gap}{gap.join(corners)}{draw(st.sampled_from(['', ' # f 1 2 3']))}")
        points += own.tolist()
        base = 0.5 * sides * np.sin(2 * np.pi / sides)
        area = 2 * base + 2 * sides * np.sin(np.pi / sides) * height
        expected[colour] = expected.get(colour, 0) + area
        areas, volume = areas + area, volume + base * height
    end = draw(st.sampled_from(["\n", "\r\n", "\r"]))
    data = end.join(["mtllib my materials.mtl", "vn 0 0 1", *text, ""]).encode()
    return data, "".join(libraries), (areas, volume), np.array(points), expected


@settings(max_examples=60)
@given(model=models())
def test_random_solids_have_their_area_volume_extent_and_colours(tmp_path_factory, model):
    data, library, sizes, points, colours = model
    folder = tmp_path_factory.mktemp("model")
    (folder / "my materials.mtl").write_text(library)
    companions = FolderCompanions(folder / "a.obj")
    surface = read(data, companions)
    assert companions.missing == companions.notes == []
    whole = surface.triangles - surface.vertices.mean(axis=0)
    volume = np.linalg.det(whole).sum() / 6
    assert (surface.face_areas.sum(), volume) == pytest.approx(sizes)
    np.testing.assert_array_equal(np.ptp(surface.vertices, axis=0), np.ptp(points, axis=0))
    found = {
        colour: surface.face_areas[(surface.face_colours == colour).all(axis=1)].sum()
        for colour in colours_of(surface)
    }
    assert found == pytest.approx(colours)
