"""A glTF file is read as its specification has it, or what is not read is refused by its name."""

import io
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mesh_files.generated import BOARD
from mesh_files.written_gltf import CUBE, CUBE_FACES, Gltf
from PIL import Image
from scipy.spatial.transform import Rotation

from meshreaders.base.errors import MeshError
from meshreaders.base.srgb import encode_srgb
from meshreaders.base.texture import CLAMP, MIRROR
from meshreaders.companions import Companions, FolderCompanions
from meshreaders.formats import gltf_files
from meshreaders.formats.gltf_files import read_gltf
from meshreaders.parts import join_parts

LIGHT = (0.5, 0.2, 0.05)
STORED = (188, 124, 63)  # LIGHT by sRGB's transfer function (IEC 61966-2-1)
HALVES = np.zeros((8, 8, 3), np.uint8)
HALVES[:, :4], HALVES[:, 4:] = (200, 0, 0), (0, 0, 200)
LEFT = np.tile(np.float32([[0.1, 0.2], [0.3, 0.2], [0.2, 0.8], [0.4, 0.8]]), (2, 1))
RIGHT = LEFT + np.float32([0.5, 0])


def read(data, companions=None):
    return join_parts(read_gltf(data, companions or Companions()))


def shown(**node):
    """A cube whose node has other values."""
    file = Gltf()
    return file.show({"mesh": file.mesh(), **node})


def extent(surface):
    corners = surface.triangles.reshape(-1, 3)
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def coloured(material=None, **attributes):
    """A cube with a material and vertex attributes, given as arrays or pairs of array and `normalized`."""
    file = Gltf()
    more = {} if material is None else {"material": file.add("materials", material)}
    put = {
        name: file.put(*value) if isinstance(value, tuple) else file.put(value)
        for name, value in attributes.items()
    }
    return file.show({"mesh": file.mesh(attributes=put, **more)})


def painted(info=None, texture=None, pixels=HALVES, material=None, **attributes):
    """A cube with an image as its base colour."""
    file = coloured(None, **attributes)
    image = file.image(pixels)
    file.add("textures", {"source": image, **(texture or {})})
    look = {"baseColorTexture": {"index": 0, **(info or {})}, **(material or {})}
    file.add("materials", {"pbrMetallicRoughness": look})
    file.tree["meshes"][0]["primitives"][0]["material"] = 0
    return file


def colours(surface):
    return sorted(set(map(tuple, surface.face_colours.tolist())))


# What stands where


@st.composite
def scenes(draw):
    """A tree of nodes with random places, each given as a matrix or by its parts, and its world matrices."""
    random = np.random.default_rng(draw(st.integers(0, 2**32)))
    count = draw(st.integers(1, 6))
    nodes, worlds = [], []
    for number in range(count):
        shift, scale = random.normal(size=3), random.uniform(0.3, 2, 3) * random.choice([-1, 1], 3)
        turn = Rotation.random(random_state=random)
        local = np.eye(4)
        local[:3, :3], local[:3, 3] = turn.as_matrix() * scale, shift
        node = {"matrix": local.T.ravel().tolist()}
        if draw(st.booleans()):
            node = {
                "translation": shift.tolist(),
                "rotation": turn.as_quat().tolist(),
                "scale": scale.tolist(),
            }
        above = draw(st.integers(-1, number - 1))
        if above >= 0:
            nodes[above].setdefault("children", []).append(number)
        nodes.append(node)
        worlds.append(local if above < 0 else worlds[above] @ local)
    return random, nodes, worlds


@given(
    scenes(), st.sampled_from(["u1", "u2", "u4", None]), st.sampled_from([0, 4, 8]), st.booleans()
)
@settings(max_examples=60)
def test_random_meshes_stand_where_their_nodes_put_them_in_their_colours(scene, index, gap, binary):
    random, nodes, worlds = scene
    file, area, volume, corners, told = Gltf(), 0.0, 0.0, [], []
    for node, world in zip(nodes, worlds, strict=True):
        points = CUBE + random.uniform(-0.3, 0.3, CUBE.shape).astype("f4")
        factor, painted_light = random.uniform(0, 1, 3), random.uniform(0, 1, 3).astype("f4")
        attributes = {"COLOR_0": file.put(np.tile(painted_light, (len(points), 1)), gap=gap)}
        material = {"pbrMetallicRoughness": {"baseColorFactor": [*factor.tolist(), 1]}}
        written, faces = points, CUBE_FACES
        if index is None:
            written, faces = points[CUBE_FACES.ravel()], None
            attributes = {"COLOR_0": file.put(np.tile(painted_light, (len(written), 1)), gap=gap)}
        node["mesh"] = file.mesh(
            written, None if faces is None else faces.astype(index), attributes,
            material=file.add("materials", material),
        )  # fmt: skip
        triangles = (points @ world[:3, :3].T + world[:3, 3])[CUBE_FACES]
        first, second = (triangles[:, one] - triangles[:, 0] for one in (1, 2))
        area += np.linalg.norm(np.cross(first, second), axis=1).sum() / 2
        volume += abs(np.linalg.det(triangles).sum()) / 6
        corners.append(triangles.reshape(-1, 3))
        told.append(np.rint(255 * encode_srgb(factor * painted_light)))
    roots = set(range(len(nodes))) - {one for node in nodes for one in node.get("children", ())}
    file.tree.update(nodes=nodes, scenes=[{"nodes": sorted(roots)}])
    surface = read(file.binary() if binary else file.text())
    everything = np.concatenate(corners)
    assert surface.face_areas.sum() == pytest.approx(area, rel=1e-6)
    # Mirrored parts, too, have their front outside.
    assert np.linalg.det(surface.triangles).sum() / 6 == pytest.approx(volume, rel=1e-5)
    np.testing.assert_allclose(
        extent(surface), [everything.min(axis=0), everything.max(axis=0)], atol=1e-5
    )
    wanted = {tuple(one) for one in np.concatenate(told).reshape(-1, 3)}
    for one in colours(surface):
        assert min(np.abs(np.subtract(one, other)).max() for other in wanted) <= 1


def test_a_scene_that_is_not_the_default_is_not_read_and_this_is_said():
    file = shown(translation=[5, 0, 0])
    file.tree["scenes"].insert(0, {"nodes": []})
    companions = Companions()
    surface = read(file.text(scene=1), companions)
    np.testing.assert_allclose(extent(surface), [[5, 0, 0], [6, 1, 1]])
    assert companions.notes == ["has 2 scenes; scene 1 is read"]
    with pytest.raises(MeshError, match="no faces"):
        read(file.text(scene=0))


def test_without_a_scene_all_root_nodes_are_read():
    file = shown()
    file.tree["nodes"] = [{"children": [1]}, {"mesh": 0}, {"mesh": 0, "translation": [2, 0, 0]}]
    del file.tree["scenes"], file.tree["scene"]
    assert read(file.text()).face_areas.sum() == pytest.approx(12)
    del file.tree["nodes"]
    with pytest.raises(MeshError, match="neither a scene nor a node"):
        read(file.text())


def test_meshes_below_a_camera_or_light_are_read_and_hidden_ones_are_not():
    file = shown()
    hidden = {"KHR_node_visibility": {"visible": False}}
    file.tree["nodes"] = [
        {"camera": 0, "children": [1], "translation": [5, 0, 0]},
        {"mesh": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"mesh": 0, "extensions": hidden, "children": [3]},
        {"mesh": 0, "scale": [9, 9, 9]},
        {"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": True}}},
    ]
    file.tree["scenes"] = [{"nodes": [0, 2, 4]}]
    surface = read(file.text())
    assert surface.face_areas.sum() == pytest.approx(12)
    np.testing.assert_allclose(extent(surface), [[0, 0, 0], [6, 1, 1]])


def test_instances_are_turned_and_moved_each_and_mirrored_ones_keep_their_front_outside():
    file = Gltf()
    attributes = {
        "TRANSLATION": file.put(np.float32([[0, 0, 0], [4, 0, 0], [8, 0, 0]])),
        "ROTATION": file.put(np.int16([[0, 0, 0, 32767]] * 2 + [[0, 0, 23170, 23170]]), True),
        "SCALE": file.put(np.float32([[1, 1, 1], [-1, 1, 1], [1, 2, 1]])),
        "_ID": file.put(np.float32([[1], [2], [3]])),
    }
    extension = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    file.show({"mesh": file.mesh(), "extensions": extension})
    surface = read(file.text(extensionsRequired=["EXT_mesh_gpu_instancing"]))
    assert surface.face_areas.sum() == pytest.approx(6 + 6 + 10)
    assert np.linalg.det(surface.triangles).sum() / 6 == pytest.approx(1 + 1 + 2)
    np.testing.assert_allclose(extent(surface), [[0, 0, 0], [8, 1, 1]], atol=1e-4)


def test_strips_and_fans_are_read_as_triangles_of_one_winding():
    square = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 2, 0], [1, 2, 0]]
    for mode, order in ((5, [0, 1, 2, 3, 4, 5]), (6, [0, 1, 5, 4])):
        file = Gltf()
        file.show({"mesh": file.mesh(square, np.uint8(order), mode=mode)})
        surface = read(file.text())
        assert surface.face_areas.sum() == pytest.approx(2)
        first, second, third = surface.triangles.transpose(1, 0, 2)
        assert (np.cross(second - first, third - first)[:, 2] > 0).all()


def test_points_and_lines_have_no_surface():
    file = shown()
    lines = {**file.tree["meshes"][0]["primitives"][0], "mode": 1}
    file.tree["meshes"][0]["primitives"].append(lines)
    assert len(read(file.text()).faces) == 12


# Numbers


@pytest.mark.parametrize(
    ("kind", "largest"), [("i1", 127), ("u1", 255), ("i2", 32767), ("u2", 65535)]
)
@pytest.mark.parametrize("normalized", [True, False])
def test_positions_may_be_integers_of_any_width(kind, largest, normalized):
    file, top = Gltf(), largest if normalized else 3
    position = {"POSITION": file.put((top * CUBE).astype(kind), normalized, gap=3)}
    file.show({"mesh": file.mesh(attributes=position)})
    surface = read(file.text(extensionsRequired=["KHR_mesh_quantization"]))
    np.testing.assert_allclose(extent(surface)[1], 1 if normalized else 3)


def test_the_lowest_normalised_integer_is_minus_one():
    file = Gltf()
    position = {"POSITION": file.put((-128 * CUBE).astype("i1"), normalized=True)}
    file.show({"mesh": file.mesh(attributes=position)})
    np.testing.assert_array_equal(extent(read(file.text())), [[-1, -1, -1], [0, 0, 0]])


def test_rows_that_are_sparse_are_put_in_their_places():
    for base in (True, False):
        file = Gltf()
        rows, values = file.put(np.uint8([5, 7])), file.put(np.float32([[3, 0, 1], [3, 1, 1]]))
        views = [file.tree["accessors"][one]["bufferView"] for one in (rows, values)]
        mesh = file.mesh()
        accessor = file.tree["accessors"][
            file.tree["meshes"][0]["primitives"][0]["attributes"]["POSITION"]
        ]
        accessor["sparse"] = {
            "count": 2,
            "indices": {"bufferView": views[0], "componentType": 5121},
            "values": {"bufferView": views[1]},
        }
        if not base:
            del accessor["bufferView"]
        file.show({"mesh": mesh})
        assert extent(read(file.text()))[1, 0] == 3


def test_a_glb_may_be_padded_by_nul_and_have_bytes_behind_its_end():
    file = shown(name="a")
    for name in ("a", "ab", "abc", "abcd"):
        file.tree["nodes"][0]["name"] = name
        assert len(read(file.binary(fill=b"\0", behind=b"more")).faces) == 12


# Poses


def morphed(weights, node=None):
    file = Gltf()
    longer = file.put(np.float32([[2, 0, 0]]) * CUBE[:, :1])
    higher = file.put(np.int8([[0, 127, 0]]) * CUBE[:, 1:2].astype("i1"), True)
    mesh = file.mesh(targets=[{"POSITION": longer}, {"POSITION": higher}])
    file.tree["meshes"][mesh]["weights"] = weights
    return file.show({"mesh": mesh, **({} if node is None else {"weights": node})})


def test_morph_targets_are_added_by_the_weights_of_the_node_or_else_of_the_mesh():
    np.testing.assert_allclose(extent(read(morphed([0.5, 1]).text()))[1], [2, 2, 1])
    np.testing.assert_allclose(extent(read(morphed([0.5, 1], [1, 0]).text()))[1], [3, 1, 1])
    with pytest.raises(MeshError, match="primitive 0 has 2 morph targets and 1 weights"):
        read(morphed([1]).text())


def with_skin(joints, weights, bound=None, **node):
    """A cube whose corners at x = 1 follow the second joint, which stands at x = 2, turned about z."""
    file = Gltf()
    turned = Rotation.from_euler("z", 90, degrees=True).as_quat().tolist()
    attributes = {"JOINTS_0": file.put(np.uint8(joints)), "WEIGHTS_0": file.put(*weights)}
    mesh = file.mesh(attributes=attributes)
    file.show({"mesh": mesh, "skin": 0, "translation": [99, 0, 0], **node}, {"children": [2]})
    file.tree["nodes"].append({"translation": [2, 0, 0], "rotation": turned})
    skin = {"joints": [1, 2]}
    if bound is not None:
        skin["inverseBindMatrices"] = file.put(np.float32(bound).transpose(0, 2, 1))
    file.tree["skins"] = [skin]
    return file


FOLLOWS = CUBE[:, 0].astype(int)[:, None] * [1, 0, 0, 0]


def test_a_skin_moves_vertices_by_their_joints_and_not_by_the_node():
    whole = np.tile(np.uint8([255, 0, 0, 0]), (8, 1)), True
    surface = read(with_skin(FOLLOWS, whole).text())
    # The joint takes (1, y, z) to (2 - y, 1, z).
    np.testing.assert_allclose(extent(surface), [[0, 0, 0], [2, 1, 1]], atol=1e-6)
    unbound = np.stack([np.eye(4), np.eye(4)])
    unbound[1, 0, 3] = -1
    surface = read(with_skin(FOLLOWS, whole, unbound).text())
    np.testing.assert_allclose(extent(surface), [[0, 0, 0], [2, 1, 1]], atol=1e-6)
    np.testing.assert_allclose(surface.triangles[2, :, 1], 0, atol=1e-6)


def test_weights_of_a_skin_are_shares_of_their_sum():
    half = np.tile(np.float32([1, 1, 0, 0]), (8, 1))
    joints = CUBE[:, 0].astype(int)[:, None] * [0, 1, 0, 0]
    surface = read(with_skin(joints, (half,)).text())
    # Half of (1, y, z) and half of (2 - y, 1, z).
    np.testing.assert_allclose(extent(surface)[1], [1.5, 1, 1], atol=1e-6)


def test_a_skin_that_is_broken_is_refused():
    whole = (np.tile(np.float32([1, 0, 0, 0]), (8, 1)),)
    with pytest.raises(MeshError, match="names joint 7; 0 to 1 are there"):
        read(with_skin(7 * FOLLOWS, whole).text())
    file = with_skin(FOLLOWS, whole)
    file.tree["nodes"][2]["children"] = [1]
    file.tree["scenes"] = [{"nodes": [0]}]
    with pytest.raises(MeshError, match="node 1 is below itself"):
        read(file.text())


# Colours


@pytest.mark.parametrize("width", [3, 4])
@pytest.mark.parametrize(("kind", "largest"), [("f4", 1), ("u1", 255), ("u2", 65535)])
def test_vertex_colours_and_factors_of_any_type_are_light(kind, largest, width):
    light = np.rint(largest * np.array([*LIGHT, 1])) if largest > 1 else np.array([*LIGHT, 1])
    rows = np.tile(light[:width], (8, 1)).astype(kind)
    for normalized in {largest > 1, False}:
        for material in (None, {}, {"pbrMetallicRoughness": {}}):
            found = colours(read(coloured(material, COLOR_0=(rows, normalized)).text()))
            np.testing.assert_allclose(found, [STORED], atol=1 if largest > 255 else 3)


def test_a_factor_is_light_and_white_without_one_and_multiplies_vertex_colours():
    assert colours(read(coloured({}).text())) == [(255, 255, 255)]
    assert colours(read(coloured().text())) == [(255, 255, 255)]
    factor = {"pbrMetallicRoughness": {"baseColorFactor": [*LIGHT, 0.1]}}
    assert colours(read(coloured(factor).text())) == [STORED]
    halves = np.full((8, 3), 0.5, "f4")
    found = colours(read(coloured(factor, COLOR_0=halves).text()))
    np.testing.assert_allclose(found, [np.rint(255 * encode_srgb(np.array(LIGHT) / 2))], atol=1)


def test_the_diffuse_colour_of_glossy_materials_is_their_colour():
    glossy = {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [*LIGHT, 1]}}
    plain = {"baseColorFactor": [1, 0, 0, 1]}
    file = coloured({"extensions": glossy, "pbrMetallicRoughness": plain})
    assert colours(read(file.text())) == [STORED]
    file = painted(TEXCOORD_0=LEFT)
    image = file.tree["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]
    extension = {"KHR_materials_pbrSpecularGlossiness": {"diffuseTexture": image}}
    file.tree["materials"] = [{"extensions": extension}]
    assert colours(read(file.text())) == [(200, 0, 0)]


@pytest.mark.parametrize(
    ("info", "attributes"),
    [
        ({}, {"TEXCOORD_0": LEFT}),
        ({}, {"TEXCOORD_0": (np.rint(65535 * LEFT).astype("u2"), True)}),
        ({}, {"TEXCOORD_0": (np.rint(255 * LEFT).astype("u1"), True)}),
        ({"texCoord": 1}, {"TEXCOORD_0": RIGHT, "TEXCOORD_1": LEFT}),
        ({"extensions": {"KHR_texture_transform": {"offset": [-0.5, 0]}}}, {"TEXCOORD_0": RIGHT}),
        ({"extensions": {"KHR_texture_transform": {"scale": [0.5, 1]}}}, {"TEXCOORD_0": 2 * LEFT}),
        (
            {"extensions": {"KHR_texture_transform": {"texCoord": 1}}},
            {"TEXCOORD_0": RIGHT, "TEXCOORD_1": LEFT},
        ),
        (
            # The lower left quarter, turned clockwise: the example of the extension.
            {"extensions": {"KHR_texture_transform": {
                "offset": [0, 1], "rotation": np.pi / 2, "scale": [0.5, 0.5]}}},
            {"TEXCOORD_0": np.tile(np.float32([[0.2, 0.2], [0.7, 0.2], [0.2, 0.7], [0.7, 0.7]]), (2, 1))},
        ),
    ],
)  # fmt: skip
def test_an_image_lies_where_its_coordinates_and_their_transform_put_it(info, attributes):
    pixels = HALVES.copy()
    if "rotation" in info.get("extensions", {}).get("KHR_texture_transform", {}):
        pixels[:4] = (0, 200, 0)
    assert colours(read(painted(info, pixels=pixels, **attributes).text())) == [(200, 0, 0)]


def test_samplers_say_how_an_image_goes_on():
    file = painted(texture={"sampler": 0}, TEXCOORD_0=LEFT)
    file.tree["samplers"] = [{"wrapS": 33071, "wrapT": 33648}]
    assert read(file.text()).texture.wraps.tolist() == [[CLAMP, MIRROR]]


def test_a_factor_and_vertex_colours_multiply_an_image_as_light():
    white = np.full((4, 4, 3), 255, np.uint8)
    white[0, 0] = 254
    material = {"baseColorFactor": [1, 0.2, 0.05, 1]}
    rows = np.tile(np.float32([0.5, 1, 1]), (8, 1))
    surface = read(painted(pixels=white, material=material, TEXCOORD_0=LEFT, COLOR_0=rows).text())
    np.testing.assert_allclose(surface.texture.images[0][3, 3], STORED, atol=1)


def test_few_vertex_colours_upon_an_image_are_kept_and_of_many_the_mean_is_said(monkeypatch):
    monkeypatch.setattr(gltf_files, "MOST_TINTS", 8)
    few = np.repeat(np.float32([[1, 1, 1], [0.2, 0.2, 0.2]]), 4, axis=0)
    surface = read(painted(TEXCOORD_0=LEFT, COLOR_0=few).text())
    assert len(surface.faces) == 12
    assert surface.face_areas.sum() == pytest.approx(6)
    assert 2 <= len(colours(surface)) <= 8
    companions = Companions()
    rows = np.random.default_rng(0).uniform(0, 1, (36, 3)).astype("f4")
    file = painted(TEXCOORD_0=np.tile(LEFT[:3], (12, 1)), COLOR_0=rows)
    primitive = file.tree["meshes"][0]["primitives"][0]
    primitive["attributes"]["POSITION"] = file.put(CUBE[CUBE_FACES.ravel()])
    del primitive["indices"]
    assert len(colours(read(file.text(), companions))) == 1
    assert companions.notes == [
        "has 12 vertex colours on an image (mesh 0, primitive 0); their mean is read"
    ]


def test_an_image_that_is_not_there_or_of_no_known_format_is_said(tmp_path):
    file = painted(TEXCOORD_0=LEFT, material={"baseColorFactor": [*LIGHT, 1]})
    for images, says in (
        ([{"uri": "no%20pe.png"}], "'no%20pe.png', which is not there"),
        ([{"uri": "data:image/png;base64,AAAA"}], "image 0 (no type), which is no image"),
    ):
        companions = FolderCompanions(tmp_path / "a.gltf")
        assert colours(read(file.text(images=images), companions)) == [STORED]
        (clause,) = companions.missing
        assert clause.startswith(says)
    textures = [{"extensions": {"KHR_texture_basisu": {"source": 0}}}]
    companions = Companions()
    assert colours(read(file.text(textures=textures), companions)) == [STORED]
    assert companions.missing == [
        "texture 0 by the extension KHR_texture_basisu, which is not read; save its image as PNG or JPEG"
    ]


def test_images_are_read_from_every_place_they_may_be_in(tmp_path):
    file = painted(TEXCOORD_0=LEFT)
    Image.fromarray(HALVES).save(tmp_path / "a b.png")
    companions = FolderCompanions(tmp_path / "a.gltf")
    assert colours(read(file.text(images=[{"uri": "a%20b.png"}]), companions)) == [(200, 0, 0)]
    stream = io.BytesIO()
    Image.fromarray(HALVES).save(stream, "WEBP", lossless=True)
    source = file.add("images", {"bufferView": file.view(stream.getvalue())})
    textures = [{"source": 5, "extensions": {"EXT_texture_webp": {"source": source}}}]
    assert colours(read(file.binary(textures=textures))) == [(200, 0, 0)]


def test_coordinates_that_are_missing_leave_the_image_out_and_this_is_said():
    companions = Companions()
    assert colours(read(painted().text(), companions)) == [(255, 255, 255)]
    assert companions.notes == [
        "has an image on mesh 0, primitive 0, which has no TEXCOORD_0; the image is not read"
    ]


# What is refused


def changed(change, file=None):
    file = painted(TEXCOORD_0=LEFT) if file is None else file
    change(file.tree)
    return file.text()


UNKNOWN = {"ACME_bend": {}}
REFUSED = {
    "required extension": (
        lambda tree: tree.update(extensionsRequired=["ACME_bend"]),
        "requires the extension ACME_bend, which is not read; export it without",
    ),
    "mode": (lambda tree: tree["meshes"][0]["primitives"][0].update(mode=7), "primitive 0 is of mode 7"),
    "required": (lambda tree: tree.update(extensionsRequired=["KHR_draco_mesh_compression"]), "requires .*KHR_draco"),
    "list for an object": (lambda tree: tree["nodes"].__setitem__(0, {"mesh": 0, "extensions": ["a"]}), "its JSON has a value of a wrong type .*; check it with"),
    "text for an object": (lambda tree: tree["materials"][0].update(pbrMetallicRoughness="red"), "its JSON has a value of a wrong type"),
    "version": (lambda tree: tree["asset"].update(version="1.0"), "version 1.0 of glTF"),
    "cycle": (lambda tree: tree["nodes"][0].update(children=[0]), "node 0 is twice in the scene"),
    "node that is not there": (lambda tree: tree["nodes"][0].update(children=[9]), "number 9 of its nodes; 1 are there"),
    "node below 0": (lambda tree: tree["nodes"][0].update(children=[-1]), "number -1 of its nodes"),
    "matrix": (lambda tree: tree["nodes"][0].update(matrix=[1, 0]), "node 0 has matrix of 2 numbers; 16"),
    "attributes": (lambda tree: tree["meshes"][0]["primitives"][0].pop("attributes"), "needs 'attributes'"),
    "rows": (lambda tree: tree["accessors"][0].update(count=3), "3 rows of TEXCOORD_0; 8 are needed"),
    "indices": (lambda tree: tree["accessors"][2].update(componentType=5122), "indices of int16"),
    "corners": (lambda tree: tree["accessors"][2].update(count=35), "35 corners, no multiple of 3"),
    "stride": (lambda tree: tree["bufferViews"][1].update(byteStride=1), "in steps of 1"),
    "claim": (lambda tree: tree["accessors"][1].update(count=10**6), "accessor 1 is truncated"),
    "all corners": (lambda tree: tree["accessors"][1].update(count=10**12), "1000000000036 vertices and corners"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_in_use_and_not_read_or_not_there_is_refused_by_its_name_and_place(name):
    change, says = REFUSED[name]
    with pytest.raises(MeshError, match=says):
        read(changed(change))


FIRST = {
    "node 0": lambda tree: tree["nodes"][0],
    "mesh 0": lambda tree: tree["meshes"][0],
    "mesh 0, primitive 0": lambda tree: tree["meshes"][0]["primitives"][0],
    "material 0": lambda tree: tree["materials"][0],
    "texture 0": lambda tree: tree["textures"][0],
    "the image of material 0": lambda tree: tree["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"],
    "image 0": lambda tree: tree["images"][0],
    "accessor 1": lambda tree: tree["accessors"][1],
    "buffer view 1": lambda tree: tree["bufferViews"][1],
    "scene 0": lambda tree: tree["scenes"][0],
}  # fmt: skip


@pytest.mark.parametrize("label", FIRST)
def test_an_extension_that_is_not_required_is_noted_once(label):
    def change(tree):
        tree["extensionsUsed"] = ["ACME_bend"]
        FIRST[label](tree)["extensions"] = UNKNOWN

    companions = Companions()
    assert colours(read(changed(change), companions)) == [(200, 0, 0)]
    assert companions.notes == [
        f"has the optional extension ACME_bend ({label}), which is not read"
    ]


def test_keys_and_attributes_that_the_format_does_not_have_are_noted():
    def change(tree):
        tree["nodes"][0]["mirror"] = "x"
        tree["meshes"][0]["primitives"][0]["bend"] = 1
        tree["meshes"][0]["primitives"][0]["attributes"]["BEND"] = 0

    companions = Companions()
    assert colours(read(changed(change), companions)) == [(200, 0, 0)]
    assert companions.notes == [
        "has 'mirror' (node 0), which is not read",
        "has 'bend' (mesh 0, primitive 0), which is not read",
        "has 'BEND' (mesh 0, primitive 0), which is not read",
    ]


@pytest.mark.parametrize("name", ["EXT_meshopt_compression", "KHR_meshopt_compression"])
def test_compressed_buffer_views_are_refused_where_the_plain_numbers_are_not_beside_them(name):
    file = shown()
    file.tree["bufferViews"][1]["extensions"] = {name: {}}
    assert len(read(file.text()).faces) == 12
    (buffer,) = json.loads(file.text())["buffers"]
    fallback = {"byteLength": len(file.data), "extensions": {name: {"fallback": True}}}
    file.tree["bufferViews"][1]["buffer"] = 1
    with pytest.raises(MeshError, match=f"buffer view 1 has the extension {name}, which is not"):
        read(file.text(buffers=[buffer, fallback]))


def test_a_required_extension_of_images_leaves_out_the_image():
    file = painted(TEXCOORD_0=LEFT)
    for name in ("KHR_texture_basisu", "MSFT_texture_dds"):
        textures = [{"extensions": {name: {"source": 0}}}]
        companions = Companions()
        data = file.text(textures=textures, extensionsUsed=[name], extensionsRequired=[name])
        assert len(read(data, companions).faces) == 12
        assert companions.missing == [
            f"texture 0 by the extension {name}, which is not read; save its image as PNG or JPEG"
        ]


def test_what_is_not_in_use_or_changes_no_surface_is_passed_over():
    def change(tree):
        tree["nodes"].append({"extensions": UNKNOWN, "mesh": 7})
        tree["materials"].append({"extensions": UNKNOWN})
        tree["materials"][0]["extensions"] = {
            "KHR_materials_clearcoat": {},
            "KHR_materials_unlit": {},
        }
        tree["extensions"] = UNKNOWN
        tree["nodes"][0]["extras"] = {"any": "thing"}

    assert colours(read(changed(change))) == [(200, 0, 0)]


def test_draco_is_refused_where_the_plain_numbers_are_not_beside_it():
    draco = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {}}}
    file = shown()
    file.tree["meshes"][0]["primitives"][0]["extensions"] = draco
    assert len(read(file.text()).faces) == 12
    for lacking in (0, 1):
        file = shown()
        file.tree["meshes"][0]["primitives"][0]["extensions"] = draco
        del file.tree["accessors"][lacking]["bufferView"]
        with pytest.raises(
            MeshError, match="0 has the extension KHR_draco_mesh_compression, which"
        ):
            read(file.text())


def test_images_of_too_many_pixels_are_refused_before_they_are_decoded():
    file = painted(TEXCOORD_0=LEFT)
    stream = io.BytesIO()
    Image.new("1", (12_000, 12_000)).save(stream, "PNG")
    file.tree["images"] = [{"bufferView": file.view(stream.getvalue())}]
    with pytest.raises(MeshError, match="image 0 has 12000 × 12000 pixels"):
        read(file.text())


def test_a_text_that_is_no_object_or_a_glb_of_another_version_is_refused():
    for data, says in (
        (json.dumps([1]).encode(), "no object"),
        (b"glTF" + bytes(3), "truncated"),
        (b"glTF\1" + shown().binary()[5:], "version 1 of GLB"),
        (shown().binary()[:-8], "truncated: its header promises"),
    ):
        with pytest.raises(MeshError, match=says):
            read(data)


def test_an_image_that_is_shared_is_one_image():
    file = painted(pixels=BOARD, TEXCOORD_0=LEFT)
    file.show({"mesh": 0}, {"mesh": 0, "translation": [3, 0, 0]})
    file.tree["nodes"] = file.tree["nodes"][1:]
    file.tree["scenes"] = [{"nodes": [0, 1]}]
    assert len(read(file.text()).texture.images) == 1


def test_joints_in_a_long_chain_are_visited_once_each(monkeypatch):
    whole = np.ones(len(CUBE), bool)
    file = with_skin(FOLLOWS, (np.float32(whole[:, None] * [1, 0, 0, 0]),))
    count = 200
    first = len(file.tree["nodes"])
    chain = [{"children": [first + number + 1]} for number in range(count - 1)] + [{}]
    file.tree["nodes"] += chain
    file.tree["skins"][0]["joints"] += [*range(first, first + count)]
    visited = []
    monkeypatch.setattr(
        gltf_files,
        "_local",
        lambda node, label, local=gltf_files._local: visited.append(label) or local(node, label),
    )
    read(file.text())
    assert len(visited) < 3 * count
