"""A file that is cut, contradicts itself, refers elsewhere or asks for without end is refused at once."""

import base64
import io
import tracemalloc
import zipfile
from functools import partial

import numpy as np
import pytest
from mesh_files.generated import (
    PLACED,
    SHAPE,
    as_dae,
    as_gltf,
    as_off,
    as_ply,
    collada,
    exported,
    model,
    object_of,
    packed,
    shape_of,
    three_mf,
)
from PIL import Image

import meshreaders
from meshreaders.base.errors import MeshError

POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
FACES = [[0, 1, 2], [0, 2, 3]]
OFF, PLY, TEXT_PLY = as_off(POINTS, FACES), as_ply(POINTS, FACES), as_ply(POINTS, FACES, "ascii")
STL = exported(POINTS, FACES, "stl")
TEXT_STL = exported(POINTS, FACES, "stl_ascii") + b"\n"
VERTICES = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"
RANDOM = np.random.default_rng(0)
CROSSING = "".join(f"v {x} {y} 0\n" for x, y in RANDOM.random((5000, 2)))
CROSSING = f"{CROSSING}f {' '.join(map(str, RANDOM.permutation(5000) + 1))}\n"


gltf = partial(as_gltf, POINTS, FACES)


def crowd(document):
    document["accessors"][0]["count"] = 300_000
    document["nodes"] = [{"mesh": 0}] * 3000
    document["scenes"][0]["nodes"] = list(range(3000))


def rows_without_data(document):
    view = {"bufferView": 0, "componentType": 5121}
    sparse = {"count": 0, "indices": view, "values": view}
    document["accessors"][1] = {
        "count": 5_000_000, "type": "VEC3", "componentType": 5126, "sparse": sparse,
    }  # fmt: skip


def large_images(document):
    """Name two small files of 12,000 x 12,000 pixels, one after another."""
    stream = io.BytesIO()
    Image.new("1", (12_000, 12_000)).save(stream, "PNG")
    uri = "data:image/png;base64," + base64.b64encode(stream.getvalue()).decode()
    document["images"] = [{"uri": uri}, {"uri": uri}]
    document["textures"] = [{"source": 0}, {"source": 1}]
    document["materials"] = [
        {"pbrMetallicRoughness": {"baseColorTexture": {"index": n}}} for n in (0, 1)
    ]
    part = document["meshes"][0]["primitives"][0]
    part["attributes"]["TEXCOORD_0"] = part["attributes"]["POSITION"]
    document["meshes"][0]["primitives"] = [{**part, "material": n} for n in (0, 1)]


def two_parts(document):
    document["accessors"][1]["count"] = 3
    document["meshes"] *= 2
    document["nodes"].append({"mesh": 1})
    document["scenes"][0]["nodes"].append(1)


TRIANGLE = object_of(SHAPE)
LARGE = "<mesh><vertices>" + '<vertex x="0" y="0" z="0"/>' * 30_000 + "</vertices></mesh>"
ENTITIES = '<!DOCTYPE a [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>'
OUTSIDE = '<components><component objectid="1" p:path="/../../etc/passwd"/></components>'


def holds(number, inside):
    components = "".join(f'<component objectid="{one}"/>' for one in inside)
    return object_of(f"<components>{components}</components>", number)


def nodes(levels):
    """Nodes that each hold the next one twice."""
    holding = (f'<node id="n{n}">' + f'<instance_node url="#n{n + 1}"/>' * 2 for n in range(levels))
    return "".join(f"{one}</node>" for one in holding) + f'<node id="n{levels}"/>'


HOSTILE = {
    "rows.ply": (as_ply(POINTS, FACES).replace(b"face 2", b"face 9" + b"0" * 14), "claims 9"),
    "negative.ply": (PLY.replace(b"face 2", b"face -1"), "'element face -1'"),
    "blank_lines.ply": (TEXT_PLY + b"\n" * 1_000_000, "1000006 lines"),
    "elements.ply": (b"ply\nformat ascii 1.0\n" + b"element e 1\n" * 10_000, "no header that ends"),
    "short_text.ply": (TEXT_PLY[:-5], "truncated: .* 2 rows of 'face', and 1 are"),
    "index.ply": (TEXT_PLY.replace(b"\n3 0 2 3", b"\n3 0 2 9"), "names vertex 9; 0 to 3"),
    "rows.off": (b"OFF\n1000000000 1000000000 0\n0 0 0\n", "truncated: .* 1000000000"),
    "rest.off": (OFF + b"3 0 1 2\n", "holds too much: .* 2 faces"),
    "corners.off": (OFF.replace(b"3 0 1 2", b"4 0 1 2"), "face 0 promises 4 corners"),
    "index.off": (OFF.replace(b"3 0 1 2", b"3 0 1 -1"), "names vertex -1; 0 to 3"),
    "hello.off": (b"hello\n1 2\n", "not OFF"),
    "materials.obj": (VERTICES + b"".join(b"usemtl m%d\nf 1 2 3\n" % n for n in range(6000)), "6000 materials"),
    "crossing.obj": (CROSSING, "not convex has 5000 corners"),
    "wide.obj": (VERTICES + b"f 1 2 3\n" * 100_000 + b"f 1 2 " + b"9" * 3000, "line 100004: a number is too large"),
    "index.obj": (VERTICES + b"f 1 2 4\n", "names vertex 4; 1 to 3"),
    "backwards.obj": (VERTICES + b"f 1 2 -4\n", "names vertex 0; 1 to 3"),
    "flat.obj": (b"v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n", "line 1: a vertex has 2 coordinates"),
    "rest.stl": (STL + STL[-50:], "holds too much: .* 2 faces"),
    "short_text.stl": (TEXT_STL + TEXT_STL[:150], "truncated: it has 4 faces, which need 12 corners, .* no end of the last solid"),
    "nodes.gltf": (gltf(nodes=[{"mesh": 0}] * 50_000, scenes=[{"nodes": list(range(50_000))}]), "5001 nodes"),
    "crowd.gltf": (gltf(crowd), "vertices and corners"),
    "nothing.gltf": (gltf(rows_without_data), "5000000 rows without data"),
    "sparse.gltf": (gltf(lambda document: document["accessors"][1].update(sparse={})), "accessor 1 needs 'count'"),
    "images.gltf": (gltf(large_images), "image 0 has 12000 × 12000 pixels"),
    "cycle.gltf": (gltf(nodes=[{"children": [1]}, {"children": [0]}], scenes=[{"nodes": [0]}]), "node 0 is twice in the scene"),
    "view.gltf": (gltf(lambda document: document["bufferViews"][1].update(byteLength=9999)), "can't be read as GLTF"),
    "two_parts.gltf": (gltf(two_parts), "names vertex 3; 0 to 2|one surface"),
    "draco.gltf": (gltf(extensionsRequired=["KHR_draco"]), "KHR_draco, which"),
    "deep.gltf": (b"[" * 1_000_000, "can't be read as GLTF"),
    "other.3mf": (packed({"a.txt": "a"}), "has no model '3d/3dmodel.model'"),
    "bomb.3mf": (three_mf(bytes(200_000_000)), "200 MB of XML"),
    "files.3mf": (packed({f"{n}": "" for n in range(6000)}), "6000 files"),
    "lzma.3mf": (packed({"3D/3dmodel.model": model(TRIANGLE)}, zipfile.ZIP_LZMA), "uses a compression"),
    "entities.3mf": (three_mf(model(TRIANGLE, before=ENTITIES)), "has a DOCTYPE"),
    "doubling.3mf": (three_mf(model("".join(holds(n, [n + 1] * 2) for n in range(1, 60)) + holds(60, []))), "5001 parts"),
    "crowd.3mf": (three_mf(model(holds(1, [2] * 4000) + object_of(LARGE, 2))), "vertices and corners"),
    "outside.3mf": (three_mf(model(object_of(OUTSIDE))), "'../../etc/passwd', which is not there"),
    "index.3mf": (three_mf(model(object_of(SHAPE.replace('v3="2"', 'v3="9"')))), "names vertex 9; 0 to 2"),
    "entities.dae": (collada(before=ENTITIES), "has a DOCTYPE"),
    "comment.dae": (collada().encode() + b"<!--" + packed({"a.dae": collada()}) + b"-->", "is a zip archive"),
    "polygons.dae": (collada(shape_of("polylist", "<vcount>2000000000</vcount><p>0 1 2</p>")), "claim 2000000000"),
    "index.dae": (as_dae(POINTS, FACES).replace(b"<p>0", b"<p>9"), "names vertex 9; 0 to 3"),
    "holes.dae": (as_dae(POINTS, FACES, "polygons").replace(b"<p>", b"<ph/><p>", 1), "polygons with holes"),
    "doubling.dae": (collada(nodes=nodes(60), scene='<node><instance_node url="#n0"/></node>'), "500. parts"),
    "crowd.dae": (collada(shape_of("triangles", f"<p>{'0 1 2 ' * 10_000}</p>"), PLACED * 2000), "vertices and corners"),
    "array.dae": (collada(shape_of("triangles", f"<p>{'0 1 2 ' * 2_000_000}</p>")), "can't be read as DAE"),
    "elements.dae": (collada(scene="<extra/>" * 300_000), "elements; 200000 are allowed"),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_named_by_the_limit_that_it_breaks_and_takes_little_memory(
    tmp_path, name
):
    content, says = HOSTILE[name]
    path = tmp_path / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    tracemalloc.start()
    with pytest.raises(MeshError, match=says) as caught:
        meshreaders.read(path, largest_megabytes=50)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 500
    assert peak < 100e6
