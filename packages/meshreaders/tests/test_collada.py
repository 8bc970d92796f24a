"""A COLLADA file is read as its specification has it, or what is not read is refused by its name."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mesh_files import written_collada as dae
from mesh_files.generated import random_prism
from mesh_files.written_gltf import CUBE, CUBE_FACES
from PIL import Image
from scipy.spatial.transform import Rotation

from meshreaders.base.errors import MeshError
from meshreaders.base.texture import CLAMP, MIRROR
from meshreaders.companions import Companions, FolderCompanions
from meshreaders.formats.collada import read_collada
from meshreaders.parts import GREY, join_parts

CUBE_SHAPE = dae.primitive("triangles", CUBE_FACES)
CUBE_GEOMETRY = dae.geometry("g", CUBE, CUBE_SHAPE)
RED = {"m": dae.effect("m", dae.colour([1, 0, 0]))}
HALVES = np.zeros((8, 8, 3), np.uint8)
HALVES[:, :4], HALVES[:, 4:] = (200, 0, 0), (0, 0, 200)


def read(data, companions=None):
    return join_parts(read_collada(data, companions or Companions()))


def extent(surface):
    corners = surface.triangles.reshape(-1, 3)
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def colours(surface):
    return sorted(set(map(tuple, surface.face_colours.tolist())))


def placed(random):
    """A random place, written as one matrix or as several steps."""
    shift, scale = random.normal(size=3), random.uniform(0.3, 2, 3) * random.choice([-1, 1], 3)
    turn = Rotation.random(random_state=random)
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn.as_matrix() * scale, shift
    vector = turn.as_rotvec(degrees=True)
    angle = np.linalg.norm(vector)
    steps = (
        f"<translate>{dae.text(shift)}</translate>"
        f"<rotate>{dae.text([*(vector / angle), angle])}</rotate><scale>{dae.text(scale)}</scale>"
    )
    return matrix, random.choice([f"<matrix>{dae.text(matrix)}</matrix>", steps])


@given(st.integers(0, 2**32), st.integers(1, 4))
@settings(max_examples=60)
def test_random_prisms_stand_where_their_nodes_put_them_in_their_colours(seed, count):
    random = np.random.default_rng(seed)
    geometries, nodes, effects, area, volume, corners, told = "", "", {}, 0.0, 0.0, [], []
    outer, outer_step = placed(random)
    for number in range(count):
        points, polygons, _, _ = random_prism(int(random.integers(2**32)))
        kind = random.choice(["polylist", "polygons", "mixed"])
        if kind == "mixed":
            sides = polygons[2:]
            shapes = dae.primitive("polygons", polygons[:2], material=f"m{number}")
            shapes += dae.primitive(
                "tristrips", [[a, b, d, c] for a, b, c, d in sides], material=f"m{number}"
            )
        else:
            shapes = dae.primitive(kind, polygons, material=f"m{number}")
        geometries += dae.geometry(f"g{number}", points, shapes, before=int(random.integers(3)))
        inner, inner_step = placed(random)
        colour = random.uniform(0, 1, 3)
        effects[f"m{number}"] = dae.effect(f"m{number}", dae.colour(colour))
        shown = dae.shape(f"g{number}", dae.bound(f"m{number}", symbol=f"m{number}"))
        nodes += dae.node(shown, f"n{number}", inner_step)
        moved = points @ (outer @ inner)[:3, :3].T + (outer @ inner)[:3, 3]
        corners.append(moved)
        told.append(np.rint(255 * colour))
        for polygon in polygons:
            ring = moved[polygon]
            area += np.linalg.norm(np.cross(ring, np.roll(ring, -1, axis=0)).sum(axis=0)) / 2
            volume += sum(np.linalg.det(ring[[0, k, k + 1]]) for k in range(1, len(ring) - 1)) / 6
            # A mirrored part keeps its front outside.
        sign = np.sign(np.linalg.det((outer @ inner)[:3, :3]))
        volume_of = sum(
            np.linalg.det(moved[polygon][[0, k, k + 1]])
            for polygon in polygons
            for k in range(1, len(polygon) - 1)
        )
        volume += (sign - 1) * volume_of / 6
    surface = read(dae.document(geometries, dae.node(nodes, "o", outer_step), effects))
    everything = np.concatenate(corners)
    assert surface.face_areas.sum() == pytest.approx(area, rel=1e-6)
    assert np.linalg.det(surface.triangles).sum() / 6 == pytest.approx(volume, rel=1e-5)
    np.testing.assert_allclose(
        extent(surface), [everything.min(axis=0), everything.max(axis=0)], atol=1e-9
    )
    assert colours(surface) == sorted({tuple(one.tolist()) for one in told})


def test_a_concave_polygon_is_covered_once():
    points = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [1, 2, 0], [0, 2, 0]]
    for first in range(6):
        ring = np.roll(np.arange(6), first)
        for kind in ("polylist", "polygons"):
            data = dae.document(
                dae.geometry("g", points, dae.primitive(kind, [ring])), dae.node(dae.shape("g"))
            )
            assert read(data).face_areas.sum() == pytest.approx(3)


@pytest.mark.parametrize("kind", ["tristrips", "trifans"])
def test_strips_and_fans_are_triangles_of_one_winding(kind):
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
    order = [0, 1, 2, 3] if kind == "tristrips" else [0, 1, 3, 2]
    shapes = dae.primitive(kind, [order, order[:3], order[:2]])
    surface = read(dae.document(dae.geometry("g", points, shapes), dae.node(dae.shape("g"))))
    first, second, third = surface.triangles.transpose(1, 0, 2)
    np.testing.assert_allclose(np.cross(second - first, third - first)[:, 2], [1, 1, 1])


@pytest.mark.parametrize(("said", "axis"), [("X_UP", "x"), ("Y_UP", "y"), ("Z_UP", "z")])
def test_the_axis_that_points_up_is_the_one_that_the_file_names(said, axis):
    companions = Companions()
    read(dae.document(CUBE_GEOMETRY, dae.node(dae.shape("g")), up=said), companions)
    assert companions.up_axis == axis


def test_hidden_nodes_are_not_read_and_a_node_is_read_as_often_as_it_stands():
    hidden = "<extra><technique profile='FCOLLADA'><visibility>0</visibility></technique></extra>"
    library = dae.node(dae.shape("g"), "inner")
    twice = "<instance_node url='#inner'/>" * 2
    nodes = dae.node(twice, "a", "<translate>5 0 0</translate>") + dae.node(
        dae.shape("g") + hidden + dae.node(dae.shape("g"), "c"), "b"
    )
    surface = read(dae.document(CUBE_GEOMETRY, nodes, library=library))
    assert len(surface.faces) == 24
    assert extent(surface)[0, 0] == 5


# Poses

JOINTS = (
    '<source id="j"><Name_array id="ja" count="2">{0}</Name_array></source>'
    '<source id="b"><float_array id="ba" count="32">{1}</float_array><technique_common><accessor '
    'source="#ba" count="2" stride="16"><param name="T" type="float4x4"/></accessor></technique_common>'
    "</source>"
)


def skin(weights, moves, names="base tip", bind=None):
    """A controller whose vertices follow joints by pairs of joint and weight."""
    inverse = np.tile(np.eye(4), (2, 1, 1)) if bind is None else bind
    shares = dae.source("w", [[1.0], [0.5], [3.0]], "W")
    pairs = [pair for vertex in weights for pair in vertex]
    return (
        '<controller id="c"><skin source="#g"><bind_shape_matrix>'
        f"{dae.text(moves)}</bind_shape_matrix>{JOINTS.format(names, dae.text(inverse))}{shares}"
        '<joints><input semantic="JOINT" source="#j"/><input semantic="INV_BIND_MATRIX" source="#b"/>'
        '</joints><vertex_weights count="8"><input semantic="JOINT" source="#j" offset="0"/>'
        '<input semantic="WEIGHT" source="#w" offset="1"/>'
        f"<vcount>{dae.whole([len(one) for one in weights])}</vcount><v>{dae.whole(pairs)}</v>"
        "</vertex_weights></skin></controller>"
    )


SHOWN_SKIN = dae.node(
    '<instance_controller url="#c"><skeleton>#base</skeleton></instance_controller>', "shown",
    "<translate>99 0 0</translate>",
)  # fmt: skip
BONES = dae.node(
    dae.node("", "tip", "<translate>2 0 0</translate><rotate>0 0 1 90</rotate>"), "base"
)
FOLLOWS = [[(int(x), 0)] for x in CUBE[:, 0]]


def test_a_skin_moves_vertices_by_their_joints_and_not_by_its_node():
    data = dae.document(CUBE_GEOMETRY, SHOWN_SKIN + BONES, controllers=skin(FOLLOWS, np.eye(4)))
    # The joint takes (1, y, z) to (2 - y, 1, z).
    np.testing.assert_allclose(extent(read(data)), [[0, 0, 0], [2, 1, 1]], atol=1e-12)
    half = [[(0, 1), (int(x), 1)] for x in CUBE[:, 0]]
    data = dae.document(CUBE_GEOMETRY, SHOWN_SKIN + BONES, controllers=skin(half, np.eye(4)))
    np.testing.assert_allclose(extent(read(data))[1], [1.5, 1, 1], atol=1e-12)


def test_a_skin_at_rest_is_its_shape_where_it_was_bound():
    tip = np.eye(4)
    tip[:3, :3] = Rotation.from_euler("z", 90, degrees=True).as_matrix()
    tip[0, 3] = 2
    controllers = skin(FOLLOWS, 2 * np.eye(4), bind=[np.eye(4), np.linalg.inv(tip)])
    surface = read(dae.document(CUBE_GEOMETRY, SHOWN_SKIN + BONES, controllers=controllers))
    np.testing.assert_allclose(extent(surface), [[0, 0, 0], [2, 2, 2]], atol=1e-12)


@pytest.mark.parametrize("above", ["", "<translate>0 0 5</translate>"])
def test_joints_of_a_skeleton_that_the_scene_does_not_show_stand_where_their_nodes_put_them(above):
    library = dae.node(BONES, "above", above) if above else BONES
    data = dae.document(
        CUBE_GEOMETRY, SHOWN_SKIN, controllers=skin(FOLLOWS, np.eye(4)), library=library
    )
    z = 5 if above else 0
    np.testing.assert_allclose(extent(read(data)), [[0, 0, z], [2, 1, z + 1]], atol=1e-12)


def test_of_joints_with_equal_names_the_first_counts():
    decoys = "".join(
        dae.node("", "tip", f"<translate>{number} 9 9</translate>") for number in range(20)
    )
    shown = SHOWN_SKIN.replace("#base", "#none")
    data = dae.document(CUBE_GEOMETRY, shown + BONES + decoys, controllers=skin(FOLLOWS, np.eye(4)))
    np.testing.assert_allclose(extent(read(data)), [[0, 0, 0], [2, 1, 1]], atol=1e-12)


def test_a_skin_whose_joint_is_no_node_of_the_scene_or_its_skeleton_is_refused():
    controllers = skin(FOLLOWS, np.eye(4), "base gone")
    says = "controller 'c' follows joint 'gone', which is no node of the scene or of its skeleton"
    for library in ("", dae.node("", "gone")):
        with pytest.raises(MeshError, match=says):
            read(
                dae.document(
                    CUBE_GEOMETRY, SHOWN_SKIN + BONES, controllers=controllers, library=library
                )
            )


def test_a_skin_of_other_counts_than_its_joints_is_refused():
    for spoil, says in (
        (lambda text: text.replace("base tip", "base"), "has 2 numbers or matrices for 1 joints"),
        (lambda text: text.replace("base tip", "base tip top"), "has 2 numbers or matrices for 3 joints"),
        (lambda text: text.replace("bind_shape_matrix>1.0 ", "bind_shape_matrix>", 1), "matrix of 15 numbers"),
    ):  # fmt: skip
        controllers = spoil(skin(FOLLOWS, np.eye(4)))
        with pytest.raises(MeshError, match=says):
            read(dae.document(CUBE_GEOMETRY, SHOWN_SKIN + BONES, controllers=controllers))


@pytest.mark.parametrize(("method", "length"), [("NORMALIZED", 1.5), ("RELATIVE", 2.5)])
def test_morph_targets_count_by_their_weights(method, length):
    targets = dae.geometry("t", CUBE * [2, 1, 1], CUBE_SHAPE)
    controllers = (
        f'<controller id="c"><morph source="#g" method="{method}"><source id="t">'
        '<IDREF_array id="ta" count="1">t</IDREF_array></source>'
        + dae.source("w", [[0.5]], "W")
        + '<targets><input semantic="MORPH_TARGET" source="#t"/>'
        '<input semantic="MORPH_WEIGHT" source="#w"/></targets></morph></controller>'
    )
    shown = dae.node('<instance_controller url="#c"/>')
    surface = read(dae.document(CUBE_GEOMETRY + targets, shown, controllers=controllers))
    scale = 1.0 if method == "NORMALIZED" else 1.5
    np.testing.assert_allclose(extent(surface)[1], [length if scale == 1 else 2.0, scale, scale])


# Colours


def test_a_shader_without_a_diffuse_colour_is_grey_and_a_constant_one_has_its_emission():
    for shader, wanted in (
        ("phong", (0, 255, 0)),
        ("blinn", (0, 255, 0)),
        ("constant", (0, 255, 0)),
    ):
        effects = {"m": dae.effect("m", dae.colour([0, 1, 0]), shader=shader)}
        data = dae.document(CUBE_GEOMETRY, dae.node(dae.shape("g", dae.bound())), effects)
        assert colours(read(data)) == [wanted]
    none = {"m": dae.effect("m", "").replace("<diffuse></diffuse>", "")}
    data = dae.document(CUBE_GEOMETRY, dae.node(dae.shape("g", dae.bound())), none)
    assert colours(read(data)) == [GREY]
    assert colours(read(dae.document(CUBE_GEOMETRY, dae.node(dae.shape("g"))))) == [GREY]


def test_a_material_that_is_named_without_being_bound_is_used():
    assert colours(read(dae.document(CUBE_GEOMETRY, dae.node(dae.shape("g")), RED))) == [
        (255, 0, 0)
    ]


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('target="#m"', 'target="#gone"', "node 'n' refers to material '#gone', which is not there"),
        ('target="#m"', 'target="b.dae#m"', "node 'n' refers to 'b.dae#m'; only references within the file are read"),
        ('<instance_effect url="#m-e"/>', '<instance_effect url="#gone"/>', "material 'm' refers to effect '#gone', which is not there"),
        ('<instance_effect url="#m-e"/>', "", "material 'm' has no effect"),
    ],
)  # fmt: skip
def test_a_material_that_is_not_there_is_noted(old, new, says):
    shown = dae.node(dae.shape("g", dae.bound()), "n")
    data = dae.document(
        CUBE_GEOMETRY.replace('material="m"', 'material="s"'),
        shown.replace('symbol="m"', 'symbol="s"'),
        RED,
    )
    assert old.encode() in data
    companions = Companions()
    surface = read(data.replace(old.encode(), new.encode()), companions)
    assert colours(surface) == [GREY]
    assert surface.face_areas.sum() == pytest.approx(6)
    assert companions.notes == [f"has faces without their colours: {says}"]


@pytest.mark.parametrize("largest", [1, 255])
def test_colours_of_corners_are_averaged_and_go_before_the_material(largest):
    rows = largest * np.tile([[0.0, 0.6, 0.2]], (8, 1))
    rows[0, 0] = largest
    inputs = '<input semantic="COLOR" source="#c" offset="1"/>'
    shapes = dae.primitive("triangles", CUBE_FACES[:1], inputs, lambda corner: (corner,))
    data = dae.document(
        dae.geometry("g", CUBE, shapes, dae.source("c", rows, "RGB")),
        dae.node(dae.shape("g", dae.bound())), RED,
    )  # fmt: skip
    assert colours(read(data)) == [(85, 153, 51)]
    white = data.replace(dae.text(rows).encode(), dae.text(np.full((8, 3), largest)).encode())
    assert colours(read(white)) == [(255, 0, 0)]


PARAMETERS = (
    '<newparam sid="f"><surface type="2D"><init_from>i</init_from></surface></newparam>'
    '<newparam sid="p"><sampler2D><source>f</source><wrap_s>CLAMP</wrap_s><wrap_t>MIRROR</wrap_t>'
    "</sampler2D></newparam>"
)


def painted(
    image="t.png",
    texture="p",
    sets='<bind_vertex_input semantic="UV" input_semantic="TEXCOORD" input_set="1"/>',
    extra="",
    uv=True,
):
    """A cube with an image whose second set of coordinates is in the left half, its first in the right."""
    left = np.tile([[0.1, 0.2], [0.3, 0.2], [0.2, 0.8], [0.4, 0.8]], (2, 1))
    inputs = (
        '<input semantic="TEXCOORD" source="#u0" offset="1" set="0"/>'
        '<input semantic="TEXCOORD" source="#u1" offset="1" set="1"/>'
    )
    shapes = dae.primitive(
        "triangles", CUBE_FACES, inputs if uv else "", lambda corner: (corner,) if uv else ()
    )
    sources = dae.source("u0", left + np.array([0.5, 0]), "ST") + dae.source("u1", left, "ST")
    diffuse = f'<texture texture="{texture}" texcoord="UV">{extra}</texture>'
    images = f'<image id="i"><init_from>{image}</init_from></image>'
    return dae.document(
        dae.geometry("g", CUBE, shapes, sources), dae.node(dae.shape("g", dae.bound(more=sets))),
        {"m": dae.effect("m", diffuse, PARAMETERS)}, images=images,
    )  # fmt: skip


def test_an_image_lies_where_the_set_that_is_bound_puts_it(tmp_path):
    Image.fromarray(HALVES).save(tmp_path / "a b.png")
    companions = FolderCompanions(tmp_path / "a.dae")
    for name in ("a%20b.png", "./a b.png", "file:///C:/models/a%20b.png", "<ref>a b.png</ref>"):
        surface = read(painted(name), companions)
        assert colours(surface) == [(200, 0, 0)]
        assert surface.texture.wraps.tolist() == [[CLAMP, MIRROR]]
    assert colours(read(painted("a b.png", texture="i"), companions)) == [(200, 0, 0)]
    assert colours(read(painted("a b.png", sets=""), companions)) == [(0, 0, 200)]
    assert companions.missing == companions.notes == []


def test_an_image_that_is_missing_or_moved_or_without_coordinates_is_said(tmp_path):
    companions = FolderCompanions(tmp_path / "a.dae")
    assert colours(read(painted("gone.png"), companions)) == [GREY]
    assert companions.missing[0].startswith("'gone.png', which is not there")
    read(painted(texture="none"), companions)
    assert companions.missing[1].startswith("image 'none' of material 'm', which the file does not")
    Image.fromarray(HALVES).save(tmp_path / "t.png")
    moved = "<extra><technique profile='MAYA'><repeatU>2</repeatU><repeatV>1</repeatV></technique></extra>"
    read(painted(extra=moved), companions)
    read(painted(uv=False), companions)
    assert companions.notes == [
        "moves the image of material 'm' by repeatU, which is not read",
        "has an image on geometry 'g', triangles 0, which has no TEXCOORD; the image is not read",
    ]


# What is refused


def spoilt(old, new, **more):
    data = dae.document(CUBE_GEOMETRY, dae.node(dae.shape("g"), "n"), **more)
    assert old.encode() in data
    return data.replace(old.encode(), new.encode())


REFUSED = {
    "geometry": (spoilt('url="#g"', 'url="#h"'), "node 'n' refers to geometry '#h', which is not there"),
    "other file": (spoilt('url="#g"', 'url="b.dae#g"'), "refers to 'b.dae#g'; only references within the file"),
    "unknown in a node": (spoilt("<instance_geometry", "<instance_hair/><instance_geometry"), "node 'n' has instance_hair"),
    "skew": (spoilt("<instance_geometry", "<skew>1 2</skew><instance_geometry"), "node 'n' has skew"),
    "matrix": (spoilt("<instance_geometry", "<matrix>1 2</matrix><instance_geometry"), "matrix of 2 numbers; 16"),
    "spline": (spoilt("<mesh>", "<spline/><other>").replace(b"</mesh>", b"</other>"), "geometry 'g' is of kind spline"),
    "unknown primitive": (spoilt("<triangles", "<patches").replace(b"</triangles", b"</patches"), "patches 0 is not read"),
    "holes": (spoilt("</triangles>", "<ph/></triangles>"), "with holes"),
    "corners": (spoilt("<p>0 ", "<p>"), "35 corners, no multiple of 3"),
    "vertex": (spoilt("<p>0 ", "<p>8 "), "triangles 0: a face names vertex 8; 0 to 7 are there"),
    "word": (spoilt("<p>0 ", "<p>x "), "holds a word that is no integer"),
    "number": (spoilt(">0.0 0.0 0.0 ", ">0,5 0.0 0.0 "), "no number: '0,5'"),
    "claim": (spoilt('<accessor source="#s-a" count="8"', '<accessor source="#s-a" count="999999999"'), "source 's' is truncated"),
    "no scene": (spoilt('id="w"', 'id="x"'), "visual_scene '#w', which is not there"),
    "axis": (spoilt("Y_UP", "UP"), "up_axis is 'UP'"),
    "root": (b"<html/>", "begins with 'html'"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_in_use_and_not_read_or_not_there_is_refused_by_its_name_and_place(name):
    data, says = REFUSED[name]
    with pytest.raises(MeshError, match=says):
        read(data)


def test_a_node_that_stands_in_itself_is_refused():
    library = dae.node('<instance_node url="#a"/>', "a")
    with pytest.raises(MeshError, match="5001 parts"):
        read(dae.document(CUBE_GEOMETRY, dae.node('<instance_node url="#a"/>'), library=library))


def test_without_a_scene_the_only_one_is_read():
    data = dae.document(CUBE_GEOMETRY, dae.node(dae.shape("g")), scene=False)
    assert len(read(data).faces) == 12


@pytest.mark.parametrize("count", [16, 17, 4000])
def test_controllers_that_deform_one_another_are_few(count):
    morphs = "".join(
        f'<controller id="c{number}"><morph source="#{f"c{number + 1}" if number < count - 1 else "g"}"/></controller>'
        for number in range(count)
    )
    shown = dae.node('<instance_controller url="#c0"/>')
    with pytest.raises(MeshError) as refusal:
        read(dae.document(CUBE_GEOMETRY, shown, controllers=morphs))
    assert ("one of more than 16 controllers" in str(refusal.value)) == (count > 16)
