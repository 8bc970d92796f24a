"""3MF and COLLADA files are read where the extra `formats` is installed, bounded as all others are."""

import zipfile

import numpy as np
import pytest
import trimesh
from meshes.generated import (
    PLACED,
    TRIANGLES,
    collada,
    model,
    object_of,
    packed,
    shape_of,
    three_mf,
)
from meshes.refusing import check_refused_at_once
from PIL import Image

from visuohaptic import optional_packages
from visuohaptic.errors import MeshError
from visuohaptic.meshes.catalogue import find_own_models
from visuohaptic.meshes.model_files import read_model

TRIANGLE = (
    '<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/>'
    '</vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh>'
)
MOVED = 'transform="1 0 0 0 1 0 0 0 1 5 0 0"'
ENTITIES = '<!DOCTYPE a [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>'


def holds(number, inside, shape=""):
    components = "".join(f'<component objectid="{one}"/>' for one in inside)
    return f'<object id="{number}">{shape}<components>{components}</components></object>'


def nested(levels, twice):
    """Nodes that each hold the next one twice."""
    inner = "".join(
        f'<node id="n{n}">' + f'<instance_node url="#n{n + 1}"/>' * twice + "</node>"
        for n in range(levels)
    )
    return inner + f'<node id="n{levels}"><instance_geometry url="#g"/></node>'


def numbers(count):
    return shape_of("triangles", f"<p>{'0 1 2 ' * (count // 3)}</p>")


LARGE = "<mesh><vertices>" + '<vertex x="0" y="0" z="0"/>' * 30_000 + "</vertices></mesh>"
HOSTILE = {
    "text.3mf": ("hello", "File is not a zip file"),
    "other.3mf": (packed({"a.txt": "a"}), "holds no 3D/3dmodel.model"),
    "no_xml.3mf": (three_mf("hello"), "Start tag expected"),
    "bomb.3mf": (three_mf(bytes(200_000_000)), "unpacks to 200 MB of XML, and 128 are allowed"),
    "files.3mf": (packed({f"{n}": "" for n in range(6000)}), "holds 6000 files; 5000 are allowed"),
    "lzma.3mf": (
        packed({"3D/3dmodel.model": model(object_of(TRIANGLE))}, zipfile.ZIP_LZMA),
        "packed in a way that 3MF does not have",
    ),
    "entities.3mf": (
        three_mf(model(object_of(TRIANGLE), before=ENTITIES)), "has a DOCTYPE, .*none is allowed"
    ),
    "itself.3mf": (three_mf(model(holds(1, [1]))), "one of its parts holds itself"),
    "doubling.3mf": (
        three_mf(model("".join(holds(n, [n + 1] * 2) for n in range(1, 60)) + object_of(TRIANGLE, 60))),
        "more than 5000 parts",
    ),
    "crowd.3mf": (
        three_mf(model(holds(1, [2] * 4000) + object_of(LARGE, 2))), "more than 60000000 vertices"
    ),
    "lost.3mf": (three_mf(model(holds(1, [7]))), "places object '7' of .*, which is not there"),
    "outside.3mf": (
        three_mf(model(object_of('<components><component objectid="1" p:path="/../../etc/passwd"/></components>'))),
        "refers to '../../etc/passwd', which it does not hold",
    ),
    "index.3mf": (
        three_mf(model(object_of(TRIANGLE.replace('v3="2"', 'v3="9"')))), "faces of the vertices 0 to 9"
    ),
    "transform.3mf": (
        three_mf(model(object_of(TRIANGLE), '<build><item objectid="1" transform="1 0 0"/></build>')),
        "a transform has 3 numbers; 12 are needed",
    ),
    "entities.dae": (collada(before=ENTITIES), "has a DOCTYPE, .*none is allowed"),
    "zip.dae": (packed({"a.dae": collada()}), "is a zip archive"),
    "polygons.dae": (
        collada(shape_of("polylist", "<vcount>2000000000</vcount><p>0 1 2</p>")),
        "claim 2000000000 corners, and 3 numbers are there",
    ),
    "itself.dae": (
        collada(nodes='<node id="n"><instance_node url="#n"/></node>', scene=""), "holds itself"
    ),
    "doubling.dae": (
        collada(nodes=nested(60, 2), scene='<node id="x"><instance_node url="#n0"/></node>'),
        "more than 5000 parts",
    ),
    "crowd.dae": (collada(numbers(30_000), PLACED * 2000), "more than 60000000 vertices"),
    "array.dae": (collada(numbers(6_000_000)), "texts is longer than 10 MB"),
    "elements.dae": (collada(scene="<extra/>" * 300_000), "elements; 200000 are allowed"),
}  # fmt: skip


def put(folder, name, content):
    (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    return folder / name


@pytest.mark.slow
@pytest.mark.parametrize("name", HOSTILE)
def test_a_file_that_claims_too_much_or_refers_elsewhere_is_refused_at_once(tmp_path, name):
    content, says = HOSTILE[name]
    check_refused_at_once(put(tmp_path, name, content), says)


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
    surface = read_model(tmp_path / f"a.{suffix}")
    assert len(surface.faces) == len(ball.faces) + 12
    np.testing.assert_allclose(np.ptp(surface.vertices, axis=0), [6.5, 2, 2], rtol=1e-6)


def test_components_of_a_3mf_are_turned_and_moved_by_all_they_stand_in(tmp_path):
    turned = 'transform="0 1 0 -1 0 0 0 0 1 0 0 0"'
    inner = f'<object id="2"><components><component objectid="3" {MOVED}/></components></object>'
    text = model(inner + object_of(TRIANGLE, 3), f'<build><item objectid="2" {turned}/></build>')
    surface = read_model(put(tmp_path, "a.3mf", three_mf(text)))
    np.testing.assert_allclose(surface.vertices, [[0, 5, 0], [0, 6, 0], [-1, 5, 0]], atol=1e-12)


def test_each_component_takes_its_own_object_of_another_file(tmp_path):
    parts = model(object_of(TRIANGLE, 1) + object_of(TRIANGLE, 2), "")
    components = "".join(
        f'<component p:path="/3D/Objects/parts.model" objectid="{number}" {MOVED * (number == 2)}/>'
        for number in (1, 2)
    )
    whole = model(f'<object id="1"><components>{components}</components></object>')
    data = packed({"3D/3dmodel.model": whole, "3D/Objects/parts.model": parts})
    surface = read_model(put(tmp_path, "a.3mf", data))
    np.testing.assert_array_equal(surface.vertices[:, 0], [0, 1, 0, 5, 6, 5])
    np.testing.assert_array_equal(surface.faces, [[0, 1, 2], [3, 4, 5]])


def test_nodes_of_a_dae_that_stand_twice_are_read_twice(tmp_path):
    assert len(read_model(put(tmp_path, "a.dae", collada(scene=PLACED * 2))).faces) == 2
    path = put(
        tmp_path, "b.dae",
        collada(nodes=nested(3, 2), scene='<node id="x"><instance_node url="#n0"/></node>'),
    )  # fmt: skip
    assert len(read_model(path).faces) == 8


def test_polygons_of_a_dae_are_cut_into_triangles(tmp_path):
    shape = shape_of("polylist", "<vcount>4</vcount><p>0 1 2 0</p>")
    assert len(read_model(put(tmp_path, "a.dae", collada(shape))).faces) == 2


def painted(paint):
    return (
        collada(TRIANGLES.replace("<triangles", '<triangles material="m"'))
        .replace("<library_geometries>", f"{paint}<library_geometries>")
        .replace(
            '<instance_geometry url="#g"/>',
            '<instance_geometry url="#g"><bind_material><technique_common>'
            '<instance_material symbol="m" target="#m"/></technique_common></bind_material>'
            "</instance_geometry>",
        )
    )


def test_a_dae_keeps_its_diffuse_colour(tmp_path):
    paint = (
        '<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert><diffuse>'
        "<color>1 0.5 0 1</color></diffuse></lambert></technique></profile_COMMON></effect>"
        '</library_effects><library_materials><material id="m"><instance_effect url="#e"/></material>'
        "</library_materials>"
    )
    surface = read_model(put(tmp_path, "a.dae", painted(paint)))
    np.testing.assert_allclose(surface.face_colours, [[255, 128, 0]], atol=1)


@pytest.mark.parametrize(("place", "is_read"), [("t.png", True), ("../t.png", False)])
def test_a_texture_of_a_dae_is_read_beside_it_alone(tmp_path, place, is_read):
    folder = tmp_path / "models"
    folder.mkdir()
    Image.fromarray(np.full((8, 8, 3), (10, 200, 30), np.uint8)).save(folder / place)
    paint = (
        f'<library_images><image id="i"><init_from>{place}</init_from></image></library_images>'
        '<library_effects><effect id="e"><profile_COMMON>'
        '<newparam sid="f"><surface type="2D"><init_from>i</init_from></surface></newparam>'
        '<newparam sid="p"><sampler2D><source>f</source></sampler2D></newparam>'
        '<technique sid="t"><lambert><diffuse><texture texture="p" texcoord="UV"/></diffuse></lambert>'
        "</technique></profile_COMMON></effect></library_effects>"
        '<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>'
    )
    text = painted(paint).replace(
        "<p>0 1 2</p>", '<input semantic="TEXCOORD" source="#u" offset="0" set="0"/><p>0 1 2</p>'
    ).replace(
        "<vertices ", '<source id="u"><float_array id="b" count="6">0 0 1 0 0 1</float_array>'
        '<technique_common><accessor source="#b" count="3" stride="2"><param name="S" type="float"/>'
        '<param name="T" type="float"/></accessor></technique_common></source><vertices ',
    )  # fmt: skip
    colours = read_model(put(folder, "a.dae", text)).face_colours
    assert (colours == [10, 200, 30]).all() == is_read


@pytest.mark.parametrize(
    ("name", "packages"), [("mug.3mf", "lxml is"), ("mug.dae", "lxml and collada are")]
)
def test_without_the_extra_one_sentence_says_what_to_install(tmp_path, monkeypatch, name, packages):
    monkeypatch.setattr(optional_packages, "find_spec", lambda name: None)
    says = rf"mug\.\w+ can't be read yet: {packages} not installed; `pip install 'visuohaptic\[formats\]'`"
    (tmp_path / "cup").mkdir()
    path = put(tmp_path / "cup", name, "hello")
    with pytest.raises(MeshError, match=says) as caught:
        read_model(path)
    assert list(find_own_models(tmp_path).set_aside.values()) == [str(caught.value)]


@pytest.mark.parametrize("name", ["mug.3mf", "mug.DAE"])
def test_with_the_extra_they_are_own_models_like_others(tmp_path, name):
    (tmp_path / "cup").mkdir()
    path = put(tmp_path / "cup", name, "")
    assert list(find_own_models(tmp_path).models.values()) == [path]
