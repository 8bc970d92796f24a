"""No file, however short, makes its reader work without end: what it claims is checked first."""

import gzip

import numpy as np
import pytest
from meshes import generated
from meshes.refusing import check_refused_at_once

from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.preparing import prepare_object

TRIANGLE_POINTS = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
CORNERS = np.array(TRIANGLE_POINTS, "<f4").tobytes()
FACE = np.array([0, 1, 2], "<u4").tobytes()
POINT = "property float x\nproperty float y\nproperty float z\n"
LIST = "property list uchar int vertex_indices\n"
COLOURS = "property uchar red\nproperty uchar green\nproperty uchar blue\n"


def glb(change=lambda document: None):
    document, data = generated.gltf_parts(TRIANGLE_POINTS, [[0, 1, 2]])
    change(document)
    return generated.packed_glb(document, data)


def ply(form, vertices, rest, faces=1, colours=""):
    header = f"ply\nformat {form} 1.0\nelement vertex {vertices}\n{POINT}"
    return f"{header}element face {faces}\n{LIST}{colours}end_header\n".encode() + rest


def claim(place, **values):
    return lambda document: document["accessors"][place].update(values)


def empty_accessor(document):
    document["accessors"][0] = {"componentType": 5126, "count": 5_000_000, "type": "VEC3"}


def many_nodes(document):
    document["nodes"] *= 50_000


def crowd(document):
    claim(1, count=300_000)(document)
    document["nodes"] *= 3000


TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
SOLID = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
SOLID += "endloop\nendfacet\nendsolid a\n"
RANDOM = np.random.default_rng(0)
CROSSING = "".join(f"v {x} {y} 0\n" for x, y in RANDOM.random((5000, 2)))
CROSSING = f"{CROSSING}f {' '.join(map(str, RANDOM.permutation(5000) + 1))}\n".encode()
HOSTILE = {
    "rows.ply": (ply("binary_little_endian", 10**15, b"0" * 100), "claims 1000000000000001 rows"),
    "text_rows.ply": (ply("ascii", 10**8, b"0 0 0\n" * 1000), "claims 100000001 rows"),
    "blank_lines.ply": (ply("ascii", 3, b"\n" * 1_000_000), "claims 4 rows, and 1000000 lines"),
    "negative.ply": (ply("ascii", -1, b""), "'element vertex -1' counts nothing"),
    "digits.ply": (ply("ascii", "9" * 5000, b""), "counts nothing"),
    "elements.ply": (
        ("ply\nformat ascii 1.0\n" + "element e 1\n" * 10_000).encode(), "no header that ends within"
    ),
    "rows.off": (b"OFF\n1000000000 1000000000 0\n0 0 0\n", "can't be read as OFF"),
    "materials.obj": (
        (TRIANGLE + "".join(f"usemtl m{n}\nf 1 2 3\n" for n in range(6000))).encode(),
        "has 6000 materials; 5000 are allowed",
    ),
    "index.obj": ((TRIANGLE + "f 1 2 99999999999\n").encode(), "can't be read as OBJ"),
    "crossing.obj": (CROSSING, "not convex has 5000 corners; 1000 are allowed"),
    "wide.off": (b"OFF\n3 100000 0\n" + b"3 0 1 2\n" * 100_003 + b"9" * 3000, "can't be read as OFF"),
    "wide.obj": ((TRIANGLE + "f 1 2 3\n" * 100_000 + f"f 1 2 {'9' * 3000}\n").encode(), "can't be read"),
    "solids.stl": ((SOLID * 6000).encode(), "has 6000 solids; 5000 are allowed"),
    "zeros.glb": (glb(claim(0, count=10**10)), "shows 20000000006 vertices and corners"),
    "nothing.glb": (glb(empty_accessor), "claims 60000000 bytes without data"),
    "nodes.glb": (glb(many_nodes), "has 50000 nodes or primitives; 5000 are allowed"),
    "crowd.glb": (glb(crowd), "vertices and corners, counted wherever a mesh stands"),
    "deep.gltf": (b"[" * 1_000_000, "its JSON is no glTF"),
    "list.gltf": (b"[]", "its JSON is no glTF"),
    "place.glb": (glb(lambda document: document["nodes"][0].update(mesh=7)), "JSON is no glTF"),
    "text.ply.gz": (
        gzip.compress(ply("ascii", 10**8, b"0 0 0\n" * 2_000_000, colours=COLOURS), 6),
        "it is text, and binary is needed",
    ),
    "rows.ply.gz": (
        gzip.compress(ply("binary_little_endian", 10**9, b"0" * 99, colours=COLOURS)),
        "claims 1000000001 rows",
    ),
    "bomb.ply.gz": (gzip.compress(bytes(60_000_000), 9), "unpacks to more than 50 MB"),
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_a_file_that_claims_too_much_is_refused_at_once(tmp_path, name):
    content, says = HOSTILE[name]
    (tmp_path / name).write_bytes(content)
    check_refused_at_once(tmp_path / name, says)


def test_what_claims_no_more_than_it_holds_is_read(tmp_path):
    (tmp_path / "good.glb").write_bytes(glb())
    (tmp_path / "good.ply").write_bytes(ply("ascii", 3, b"0 0 0\n1 0 0\n0 1 0\n3 0 1 2"))
    binary = CORNERS + b"\3" + FACE
    (tmp_path / "binary.ply").write_bytes(ply("binary_little_endian", 3, binary))
    for file in tmp_path.iterdir():
        assert len(prepare_object(Model("a", "b"), file, MeshParameters()).faces) == 1
