"""3MF and COLLADA files are read, bounded as all others are."""

import numpy as np
import pytest
import trimesh
from mesh_files.generated import PLACED, SHAPE, TRIANGLES, collada, model, object_of, packed
from PIL import Image

import meshreaders

MOVED = 'transform="1 0 0 0 1 0 0 0 1 5 0 0"'


def put(folder, name, content):
    (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    return folder / name


@pytest.mark.parametrize("suffix", ["3mf", "dae"])
def test_the_parts_of_a_scene_stand_where_the_scene_puts_them(tmp_path, suffix):
    scene = trimesh.Scene()
    ball = trimesh.creation.icosphere(1)
    scene.add_geometry(ball, transform=trimesh.transformations.translation_matrix([5, 0, 0]))
    scene.add_geometry(trimesh.creation.box())
    # trimesh writes each shape into a DAE as if it stood at the origin.
    shapes = scene.dump() if suffix == "dae" else scene
    put(tmp_path, f"a.{suffix}", trimesh.exchange.dae.export_collada(shapes)
        if suffix == "dae" else shapes.export(file_type="3mf"))  # fmt: skip
    surface = meshreaders.read(tmp_path / f"a.{suffix}")
    assert len(surface.faces) == len(ball.faces) + 12
    np.testing.assert_allclose(np.ptp(surface.vertices, axis=0), [6.5, 2, 2], rtol=1e-6)


def test_components_of_a_3mf_are_turned_and_moved_by_all_they_stand_in_in_each_file(tmp_path):
    turned = 'transform="0 1 0 -1 0 0 0 0 1 0 0 0"'
    parts = model(object_of(SHAPE, 1) + object_of(SHAPE, 2), "")
    path = 'p:path="/3D/Objects/parts.model"'
    components = f'<component {path} objectid="1"/><component {path} objectid="2" {MOVED}/>'
    whole = model(
        object_of(f"<components>{components}</components>", 3),
        f'<build><item objectid="3" {turned}/></build>',
    )
    data = packed({"3D/3dmodel.model": whole, "3D/Objects/parts.model": parts})
    surface = meshreaders.read(put(tmp_path, "a.3mf", data))
    corners = np.array([[0, 0, 0], [0, 1, 0], [-1, 0, 0]])
    np.testing.assert_array_equal(surface.triangles, [corners, np.add(corners, [0, 5, 0])])


def test_nodes_of_a_dae_are_read_as_often_as_they_stand(tmp_path):
    assert len(meshreaders.read(put(tmp_path, "a.dae", collada(scene=PLACED * 2))).faces) == 2
    pair = '<instance_node url="#{0}"/>' * 2
    nodes = f'<node id="a">{pair.format("b")}</node><node id="b">{pair.format("n")}</node>{PLACED}'
    path = put(tmp_path, "b.dae", collada(nodes=nodes, scene=f"<node>{pair.format('a')}</node>"))
    assert len(meshreaders.read(path).faces) == 8


TEXTURED = """<newparam sid="f"><surface type="2D"><init_from>i</init_from></surface></newparam>
<newparam sid="p"><sampler2D><source>f</source></sampler2D></newparam>"""
UV = """<source id="u"><float_array id="b" count="6">0 0 1 0 0 1</float_array><technique_common>
<accessor source="#b" count="3" stride="2"><param name="S" type="float"/>
<param name="T" type="float"/></accessor></technique_common></source>"""


def painted(diffuse, before="", image=""):
    """A triangle whose material has a diffuse colour or an image."""
    paint = (
        f'<library_images><image id="i"><init_from>{image}</init_from></image></library_images>'
        f'<library_effects><effect id="e"><profile_COMMON>{before}<technique sid="t"><lambert>'
        f"<diffuse>{diffuse}</diffuse></lambert></technique></profile_COMMON></effect></library_effects>"
        '<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>'
    )
    bound = (
        '<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="m" '
        'target="#m"/></technique_common></bind_material></instance_geometry>'
    )
    shape = TRIANGLES.replace("<triangles", '<triangles material="m"').replace(
        "<p>", '<input semantic="TEXCOORD" source="#u" offset="0" set="0"/><p>'
    )
    text = collada(shape, PLACED.replace('<instance_geometry url="#g"/>', bound))
    text = text.replace("<vertices ", f"{UV}<vertices ")
    return text.replace("<library_geometries>", f"{paint}<library_geometries>")


def test_a_dae_keeps_its_diffuse_colour(tmp_path):
    surface = meshreaders.read(put(tmp_path, "a.dae", painted("<color>1 0.5 0 1</color>")))
    np.testing.assert_allclose(surface.face_colours, [[255, 128, 0]], atol=1)


@pytest.mark.parametrize(("place", "is_read"), [("t.png", True), ("../t.png", False)])
def test_a_texture_of_a_dae_is_read_beside_it_alone(tmp_path, place, is_read):
    folder = tmp_path / "models"
    folder.mkdir()
    Image.fromarray(np.full((8, 8, 3), (10, 200, 30), np.uint8)).save(folder / place)
    text = painted('<texture texture="p" texcoord="UV"/>', TEXTURED, place)
    colours = meshreaders.read(put(folder, "a.dae", text)).face_colours
    assert (colours == [10, 200, 30]).all() == is_read
