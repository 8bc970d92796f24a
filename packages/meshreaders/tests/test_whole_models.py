"""A model is what its file says, over models made by a seed, written by another program or here."""

import io
from functools import partial

import numpy as np
import pytest
from mesh_files import generated
from mesh_files.generated import FACES, POINTS

import meshreaders
from meshreaders.base.errors import MeshError


def read(data, kind):
    return meshreaders.read(io.BytesIO(data), kind)


@pytest.mark.parametrize("name", ["obj", "off", "text ply", "stl_ascii", "dae", "gltf"])
def test_a_byte_order_mark_is_no_part_of_the_model(name):
    data = OF_TRIANGLES[name](POINTS, FACES)
    surface = read(b"\xef\xbb\xbf" + data, kind_of(name))
    np.testing.assert_array_equal(surface.triangles, [POINTS])


@pytest.mark.parametrize("name", ["KHR_materials_unlit", "KHR_lights_punctual"])
def test_a_required_extension_that_leaves_the_surface_alone_is_read(name):
    data = generated.as_gltf(POINTS, FACES, extensionsRequired=[name])
    assert len(read(data, "gltf").faces) == 1


def test_names_of_solids_are_no_part_of_the_model():
    text = generated.exported(POINTS, FACES, "stl_ascii")
    named = text.replace(b"solid", b"solid vertex of a solid")
    assert len(read(named + b"\n" + text, "stl").faces) == 2


@pytest.mark.parametrize(
    "text",
    [
        b"v\t0 0 0\nv 1\t0 0\n v 0 1 0\nf\t1 2 3\n",
        b"v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n",
        b"v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 \\\n2 3 # a face\nf 1 2\nf\n",
    ],
    ids=["tabs", "windows", "old mac", "continued"],
)
def test_an_obj_is_the_same_however_its_lines_are_written(text):
    np.testing.assert_array_equal(read(text, "obj").triangles, [POINTS])


SEEDS = range(12)
WITH_POLYGONS = {
    "obj": generated.as_obj,
    "backwards obj": generated.as_obj_backwards,
    "off": generated.as_off,
    "ply": generated.as_ply,
    "text ply": lambda points, faces: generated.as_ply(points, faces, "ascii"),
    "dae": generated.as_dae,
    "polygons dae": lambda points, faces: generated.as_dae(points, faces, "polygons"),
}


@pytest.mark.parametrize("name", WITH_POLYGONS)
def test_a_prism_of_any_outline_has_its_area_and_volume(name):
    kind = name.rpartition(" ")[2]
    for seed in SEEDS:
        points, faces, area, volume = generated.random_prism(seed)
        surface = read(WITH_POLYGONS[name](points, faces), kind)
        assert surface.face_areas.sum() == pytest.approx(area, rel=1e-5), seed
        assert np.linalg.det(surface.triangles).sum() / 6 == pytest.approx(volume, rel=1e-5), seed


OF_TRIANGLES = {
    **{name: made for name, made in WITH_POLYGONS.items() if not name.endswith(" obj")},
    "gltf": generated.as_gltf,
    **{kind: partial(generated.exported, kind=kind) for kind in ("stl", "stl_ascii", "glb", "3mf")},
}


def kind_of(name):
    return name.removesuffix("_ascii").rpartition(" ")[2]


def random_triangles(seed):
    """Triangles of any kind: closed or not, some used twice, vertices that no face names."""
    random = np.random.default_rng(seed)
    points = np.float32(random.normal(size=(int(random.integers(4, 40)), 3))).astype(float)
    count = random.integers(1, 60)
    triangles = [random.choice(len(points), 3, replace=False).tolist() for _ in range(count)]
    return points, triangles


def in_any_order(triangles):
    """Sort triangles, whichever of their corners comes first."""
    corners = np.reshape(triangles, (-1, 3, 3))
    first = corners[..., 0].argmin(axis=1)[:, None]
    rows = np.take_along_axis(corners, ((first + np.arange(3)) % 3)[..., None], axis=1)
    rows = np.round(rows.reshape(-1, 9), 5) + 0.0
    return rows[np.lexsort(rows.T)]


@pytest.mark.parametrize("name", OF_TRIANGLES)
def test_triangles_are_those_that_were_written(name):
    for seed in SEEDS:
        points, faces = random_triangles(seed)
        found = read(OF_TRIANGLES[name](points, faces), kind_of(name)).triangles
        np.testing.assert_allclose(
            in_any_order(found), in_any_order(points[faces]), atol=2e-5, err_msg=f"seed {seed}"
        )


@pytest.mark.parametrize("name", [name for name in OF_TRIANGLES if name not in {"obj", "3mf"}])
def test_a_file_cut_anywhere_is_refused_or_whole(name):
    """OBJ has no counts, and zip archives are checked by their own sums."""
    for seed in SEEDS:
        points, faces = random_triangles(seed)
        data = OF_TRIANGLES[name](points, faces)
        where = int(np.random.default_rng(seed).integers(1, len(data)))
        try:
            found = read(data[:where], kind_of(name)).triangles
        except MeshError:
            continue
        # Only the end of the last line or tag, or digits of the last number, may be missing.
        assert len(data) - where < 25, (seed, where, len(data))
        assert len(found) == len(faces)
