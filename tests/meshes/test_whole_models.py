"""A model is what its file says: a cut or contradictory one is refused, all others as a second reader sees them."""

import copy
import io
import json

import numpy as np
import pytest
import trimesh
from meshes import generated

from visuohaptic.errors import MeshError
from visuohaptic.meshes.model_files import read_model, read_open_file

SPHERE = trimesh.creation.icosphere(2)
POINTS, FACES = np.asarray(SPHERE.vertices), np.asarray(SPHERE.faces).tolist()
CORNERS = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"


def read(data, kind):
    return read_open_file(io.BytesIO(data), f"model.{kind}", f".{kind}")


def refused(data, kind, says):
    with pytest.raises(MeshError, match=says) as caught:
        read(data, kind)
    assert str(caught.value).startswith(f"model.{kind} can't be read as ")
    assert "\n" not in str(caught.value)


OFF = generated.as_off(POINTS, FACES)
STL = generated.as_stl(POINTS, FACES)
TEXT_STL = generated.as_text_stl(POINTS, FACES)
PLY = generated.as_ply(POINTS, FACES)
TEXT_PLY = generated.as_ply(POINTS, FACES, "ascii")
GLB = generated.as_glb(POINTS, FACES)


def half(data):
    """Cut a text after half of its lines."""
    lines = data.split(b"\n")
    return b"\n".join(lines[: len(lines) // 2])


@pytest.mark.parametrize(
    ("kind", "data", "says"),
    [
        ("off", half(OFF), r"truncated: .* promises 162 vertices and 320 faces, .* and 240 lines follow"),
        ("off", b"OFF\n3 1000000000 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "truncated: .*1000000000 faces.* 4 lines"),
        ("off", OFF + b"3 0 1 2\n", "holds too much: .* 320 faces"),
        ("off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n", "face 0 promises 4 corners, and 3 numbers follow"),
        ("off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "names vertex 3; 0 to 2 are there"),
        ("off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "names vertex -1; 0 to 2 are there"),
        ("stl", STL[:-10], "truncated: its header promises 320 faces, hence 16084 bytes, and 16074 are there"),
        ("stl", STL[:80] + b"\xff" * 4 + STL[84:], "truncated: its header promises 4294967295 faces"),
        ("stl", STL[:60], "truncated: a header of 84 bytes is needed, and 60 bytes are there"),
        ("stl", STL + bytes(50), "holds too much: its header promises 320 faces"),
        ("stl", half(TEXT_STL), "truncated: 1 solids, 160 faces and so 480 corners are promised, and 0 ends"),
        ("stl", TEXT_STL + half(TEXT_STL), "truncated: 2 solids"),
        ("ply", PLY[:-10], "claims 482 rows|truncated: its header promises 320 rows of 'face', and 319 are"),
        ("ply", half(TEXT_PLY), "truncated: its header promises 320 rows of 'face', and 7. are there whole"),
        ("ply", TEXT_PLY[:-5], "truncated: its header promises 320 rows of 'face', and 319 are there whole"),
        ("ply", TEXT_PLY.replace(b"\n3 ", b"\n3 999 ", 1), "names vertex 999; 0 to 161"),
        ("glb", GLB[:-10], r"truncated: its header promises \d+ bytes, and \d+ are there"),
        ("obj", CORNERS + b"f 0 1 2\n", "names vertex 0; 1 to 3 are there"),
        ("obj", CORNERS + b"f 1 2 4\n", "names vertex 4; 1 to 3 are there"),
        ("obj", CORNERS + b"f 1 2 -4\n", "names vertex 0; 1 to 3 are there"),
    ],
)  # fmt: skip
def test_what_is_not_whole_or_names_no_vertex_is_refused_in_one_sentence(kind, data, says):
    refused(data, kind, says)


@pytest.mark.parametrize(
    ("kind", "data"),
    [("obj", CORNERS + b"f 1 2 3\n"), ("off", OFF), ("ply", TEXT_PLY), ("stl", TEXT_STL)],
)
def test_a_byte_order_mark_is_no_part_of_the_model(kind, data):
    np.testing.assert_array_equal(
        read(b"\xef\xbb\xbf" + data, kind).triangles, read(data, kind).triangles
    )


def glb(change):
    document, data = generated.gltf_parts(POINTS, FACES)
    document = copy.deepcopy(document)
    change(document)
    return generated.packed_glb(document, data)


def requires(name):
    return lambda document: document.update(extensionsUsed=[name], extensionsRequired=[name])


@pytest.mark.parametrize(
    "name",
    ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_mesh_quantization", "X_y"],
)
def test_a_required_extension_that_is_not_read_is_named(name):
    refused(glb(requires(name)), "glb", f"requires the extension {name}, which is not read")


@pytest.mark.parametrize("name", ["KHR_materials_unlit", "KHR_lights_punctual"])
def test_a_required_extension_that_leaves_the_surface_alone_is_read(name):
    assert len(read(glb(requires(name)), "glb").faces) == 320


def accessor(place, **values):
    return lambda document: document["accessors"][place].update(values)


def view(place, **values):
    return lambda document: document["bufferViews"][place].update(values)


def part(**values):
    return lambda document: document["meshes"][0]["primitives"][0].update(values)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda document: document["buffers"][0].update(byteLength=9999),
         "truncated: buffer 0 is promised to have 9999 bytes, and 5784 are there"),
        (view(1, byteLength=9999), "truncated: the buffer of view 1 is promised to have 11943 bytes, and 5784"),
        (accessor(0, count=163), "truncated: the view of accessor 0 is promised to have 1956 bytes, and 1944"),
        (accessor(1, count=963), "truncated: the view of accessor 1 is promised to have 3852 bytes, and 3840"),
        (accessor(0, byteOffset=8), "truncated: the view of accessor 0"),
        (accessor(0, sparse={"count": 1}), "accessor 0 is sparse, which is not read"),
        (lambda document: document["accessors"][0].pop("bufferView"), "accessor 0 promises 162 rows and has no data"),
        (part(mode=6), "one of its parts is a fan of triangles; triangles or strips are needed"),
    ],
)  # fmt: skip
def test_a_gltf_that_promises_more_than_trimesh_reads_is_refused(change, says):
    refused(glb(change), "glb", says)


def test_a_buffer_beside_a_gltf_that_is_cut_is_refused(tmp_path):
    document, data = generated.gltf_parts(POINTS, FACES)
    document["buffers"][0]["uri"] = "a.bin"
    (tmp_path / "a.gltf").write_text(json.dumps(document))
    (tmp_path / "a.bin").write_bytes(data)
    assert len(read_model(tmp_path / "a.gltf").faces) == 320
    (tmp_path / "a.bin").write_bytes(data[:-1])
    with pytest.raises(MeshError, match="buffer 0 is promised to have 5784 bytes, and 5783 are"):
        read_model(tmp_path / "a.gltf")


def test_a_face_of_one_part_names_no_vertex_of_the_next():
    document, data = generated.gltf_parts(POINTS, FACES)
    document["accessors"][0]["count"] = 100
    document["meshes"] *= 2
    document["nodes"].append({"mesh": 1})
    document["scenes"][0]["nodes"].append(1)
    refused(
        generated.packed_glb(document, data),
        "glb",
        r"names vertex \d+; 0 to 99 are there|one surface",
    )


def test_a_dae_with_parts_that_are_left_out_or_without_a_vertex_is_refused():
    data = generated.as_dae(POINTS, FACES)
    refused(data.replace(b"polylist", b"tristrips"), "dae", "it has tristrips, which are not read")
    refused(data.replace(b"<p>0", b"<p>999", 1), "dae", "names vertex 999|names vertex")
    refused(
        data.replace(b"<vcount>3 3", b"<vcount>3 4"), "dae", "polygons claim 961 corners, and 960"
    )


def test_names_of_solids_are_no_part_of_the_model():
    assert len(read(TEXT_STL, "stl").faces) == 320
    twice = read(TEXT_STL + TEXT_STL.replace(b"vertex of a solid", b"facet"), "stl")
    assert len(twice.faces) == 640


@pytest.mark.parametrize(
    "text",
    [
        b"v\t0 0 0\nv 1\t0 0\n v 0 1 0\nf\t1 2 3\n",
        b"v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n",
        b"v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 \\\n2 3 # a face\nf 1 2\nf\n",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 9 9 9\nv 9 9 9\n",
    ],
    ids=["tabs", "windows", "old mac", "continued", "counting backwards"],
)
def test_an_obj_is_the_same_however_its_lines_are_written(text):
    np.testing.assert_array_equal(read(text, "obj").triangles, [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]])


# Each format by a generator of its own and a second reader, over models made by a seed.

SEEDS = range(12)
WITH_POLYGONS = {
    "obj": generated.as_obj,
    "backwards obj": generated.as_obj_backwards,
    "blender obj": generated.as_obj_by_blender,
    "off": generated.as_off,
    "ply": generated.as_ply,
    "text ply": lambda points, faces: generated.as_ply(points, faces, "ascii"),
    "dae": generated.as_dae,
    "polygons dae": lambda points, faces: generated.as_dae(points, faces, "polygons"),
}


def volume(surface):
    return np.linalg.det(surface.triangles).sum() / 6


@pytest.mark.parametrize("name", WITH_POLYGONS)
def test_a_prism_of_any_outline_has_its_area_and_volume(name):
    kind = name.rpartition(" ")[2]
    for seed in SEEDS:
        shape = generated.random_prism(seed)
        surface = read(WITH_POLYGONS[name](shape.points, shape.faces), kind)
        assert surface.face_areas.sum() == pytest.approx(shape.area, rel=1e-5), seed
        assert volume(surface) == pytest.approx(shape.volume, rel=1e-5), seed


def as_gltf(points, faces):
    data = io.BytesIO(generated.as_glb(points, faces))
    scene = trimesh.load_scene(data, file_type="glb", process=False)
    files = trimesh.exchange.gltf.export_gltf(scene, merge_buffers=True, embed_buffers=True)
    return files["model.gltf"]


OF_TRIANGLES = {
    **{name: made for name, made in WITH_POLYGONS.items() if not name.endswith(" obj")},
    "stl": generated.as_stl,
    "text stl": generated.as_text_stl,
    "glb": generated.as_glb,
    "gltf": as_gltf,
    "3mf": generated.as_3mf,
}
OPEN3D_READS = {"obj", "off", "ply", "stl", "glb", "gltf"}


def random_triangles(seed):
    """Triangles of any kind: closed or not, some used twice, vertices that no face names."""
    random = np.random.default_rng(seed)
    points = np.float32(random.normal(size=(int(random.integers(4, 40)), 3))).astype(float)
    triangles = [
        random.choice(len(points), 3, replace=False) for _ in range(random.integers(1, 60))
    ]
    return points, np.array(triangles).tolist()


def in_any_order(triangles):
    """Sort triangles, whichever of their corners comes first."""
    corners = np.reshape(triangles, (-1, 3, 3))
    first = corners[..., 0].argmin(axis=1)[:, None]
    rows = np.take_along_axis(corners, ((first + np.arange(3)) % 3)[..., None], axis=1)
    rows = np.round(rows.reshape(-1, 9), 5) + 0.0
    return rows[np.lexsort(rows.T)]


def second_reading(data, kind, folder):
    """Triangles as trimesh or Open3D reads the file with no step of ours."""
    if kind not in OPEN3D_READS:
        return trimesh.load_mesh(io.BytesIO(data), file_type=kind, process=False).triangles
    from visuohaptic.geometry.compiled_open3d import open3d

    path = folder / f"model.{kind}"
    path.write_bytes(data)
    mesh = open3d.io.read_triangle_mesh(str(path))
    return np.asarray(mesh.vertices)[np.asarray(mesh.triangles)]


@pytest.mark.parametrize("name", OF_TRIANGLES)
def test_triangles_are_those_that_a_second_reader_sees(tmp_path, name):
    kind = name.rpartition(" ")[2]
    for seed in SEEDS:
        points, faces = random_triangles(seed)
        data = OF_TRIANGLES[name](points, faces)
        found = read(data, kind).triangles
        np.testing.assert_allclose(in_any_order(found), in_any_order(points[faces]), atol=2e-5)
        other = second_reading(data, kind, tmp_path)
        np.testing.assert_allclose(
            in_any_order(found), in_any_order(other), atol=2e-5, err_msg=f"seed {seed}"
        )


@pytest.mark.parametrize("name", [name for name in OF_TRIANGLES if name not in {"obj", "3mf"}])
def test_a_file_cut_anywhere_is_refused_or_whole(name):
    """OBJ has no counts, and zip archives are checked by their own sums."""
    kind = name.rpartition(" ")[2]
    for seed in SEEDS:
        points, faces = random_triangles(seed)
        data = OF_TRIANGLES[name](points, faces)
        where = int(np.random.default_rng(seed).integers(1, len(data)))
        try:
            found = read(data[:where], kind).triangles
        except MeshError:
            continue
        # Only the end of the last line or tag, or digits of the last number, may be missing.
        assert len(data) - where < 25, (seed, where, len(data))
        assert len(found) == len(faces)
