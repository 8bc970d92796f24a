"""A model becomes upright, clean, centred and of unit size, or is refused by name."""

import io

import numpy as np
import pytest
import trimesh
from mesh_files.written_gltf import Gltf
from numerics.surfaces import build_plain_surface, of_trimesh

from meshreaders.base.texture import Texture
from visuohaptic.base.errors import MeshError
from visuohaptic.geometry.surface import Surface, write_surface
from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.preparing import (
    clean,
    normalise,
    prepare_object,
)
from visuohaptic.meshes.up_axis import rotation_upright


def surface_of(mesh):
    return of_trimesh(mesh, np.arange(len(mesh.faces) * 3).reshape(-1, 3) % 256)


@pytest.fixture(scope="module")
def lopsided():
    box = trimesh.creation.box((3, 0.2, 0.5)).apply_translation((1, 0.5, 0))
    return surface_of(trimesh.util.concatenate([trimesh.creation.icosphere(2), box]))


def test_the_centroid_is_at_the_origin_and_the_farthest_vertex_at_one(lopsided):
    result = normalise(lopsided, "lopsided").surface
    assert np.linalg.norm(result.vertices, axis=1).max() == pytest.approx(1, abs=1e-7)
    centroid = np.average(result.triangles.mean(axis=1), axis=0, weights=result.face_areas)
    np.testing.assert_allclose(centroid, 0, atol=1e-7)
    np.testing.assert_array_equal(result.vertices, result.vertices.astype(np.float32))


def test_dimensions_stretch_each_axis_but_an_extent_of_zero():
    box = surface_of(trimesh.creation.box((1, 1, 1)))
    extent = np.ptp(normalise(box, "box", dimensions=(10, 40, 20)).surface.vertices, axis=0)
    np.testing.assert_allclose(extent / extent[0], [1, 4, 2], rtol=1e-6)
    sheet = build_plain_surface([[0, 0, 0], [1, 0, 0], [0, 0, 1]], [[0, 1, 2]])
    extent = np.ptp(normalise(sheet, "sheet", dimensions=(2, 1, 1)).surface.vertices, axis=0)
    np.testing.assert_allclose(extent / extent[0], [1, 0, 0.5], rtol=1e-6)


def test_merged_vertices_do_not_depend_on_the_order_of_vertices(lopsided):
    generator = np.random.default_rng(7)
    apart = lopsided.triangles.reshape(-1, 3)
    apart = apart + generator.uniform(-1e-8, 1e-8, apart.shape)
    count = len(apart)
    wanted = clean(Surface(apart, np.arange(count).reshape(-1, 3), lopsided.face_colours), 1e-6)
    assert len(wanted.vertices) < count / 3
    for _ in range(5):
        order = generator.permutation(count)
        faces = np.argsort(order).reshape(-1, 3)
        found = clean(Surface(apart[order], faces, lopsided.face_colours), 1e-6)
        np.testing.assert_array_equal(found.triangles, wanted.triangles)


def test_coincident_vertices_merge_and_useless_faces_go(lopsided):
    faces = lopsided.faces
    shifted = faces + len(lopsided.vertices)
    doubled = Surface(
        np.concatenate([lopsided.vertices, lopsided.vertices + 1e-9]),
        np.concatenate([faces, shifted[:, ::-1], [[0, 0, 1]], [[0, 1, len(lopsided.vertices)]]]),
        np.zeros((2 * len(faces) + 2, 3), dtype=np.uint8),
    )
    result, alone = clean(doubled, 1e-6), clean(lopsided, 1e-6)
    assert (len(result.faces), len(result.vertices)) == (len(alone.faces), len(alone.vertices))
    assert (result.face_areas > 0).all()


def test_the_way_leads_to_the_vertices_also_where_faces_go(lopsided):
    twice = lopsided.faces[:300]
    doubled = Surface(
        lopsided.vertices,
        np.concatenate([lopsided.faces, twice]),
        np.concatenate([lopsided.face_colours, lopsided.face_colours[:300]]),
    )
    made, way = normalise(doubled, "doubled", rotation_upright("z"), (1, 2, 3))
    led = doubled.triangles @ way[:3, :3].T + way[:3, 3]
    np.testing.assert_allclose(led[: len(made.faces)], made.triangles, atol=1e-6)


def test_colours_and_images_stay_with_their_faces():
    box = surface_of(trimesh.creation.box((1, 1, 1)))
    count = len(box.faces) + 1
    corners = np.arange(6.0 * count, dtype=np.float32).reshape(count, 3, 2)
    numbers = (np.arange(count) % 3 - 1).astype(np.int32)
    images = tuple(np.full((2, 3, 3), colour, np.uint8) for colour in (10, 20))
    spoiled = Surface(
        box.vertices,
        np.concatenate([[[0, 0, 1]], box.faces]),
        np.concatenate([[[9, 9, 9]], box.face_colours]).astype(np.uint8),
        Texture(corners, numbers, images, np.zeros((2, 2), np.uint8)),
    )
    made = normalise(spoiled, "box", rotation_upright("z")).surface
    np.testing.assert_array_equal(made.face_colours, box.face_colours)
    np.testing.assert_array_equal(made.texture.corners, corners[1:])
    np.testing.assert_array_equal(made.texture.image, numbers[1:])
    assert made.texture.images is images


TRIANGLE = np.array([[0, 1, 2]])


@pytest.mark.parametrize(
    ("vertices", "faces", "sentence"),
    [
        ([[0.0, 0, 0], [1, 0, 0], [0, np.nan, 0]], TRIANGLE, "has 1 NaN or infinite vertices, the first has index 2"),
        ([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]], TRIANGLE, "has no area"),
        ([[1.0, 1, 1]] * 3, TRIANGLE, "all its vertices are at one point"),
        ([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], np.zeros((0, 3), int), "has no faces"),
        ([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 7]], "names vertex 7; 0 to 2 are there"),
    ],
)  # fmt: skip
def test_what_can_not_be_touched_is_refused_by_name(vertices, faces, sentence):
    surface = build_plain_surface(vertices, faces)
    with pytest.raises(MeshError, match=f"a/b.obj {sentence}|a/b.obj .*{sentence}"):
        normalise(surface, "a/b.obj")


def test_own_models_with_z_up_are_turned(tmp_path):
    trimesh.creation.box((1, 1, 4)).export(tmp_path / "tower.stl")
    model = Model("tower", "tower")
    result = prepare_object(model, tmp_path / "tower.stl", MeshParameters(own_up_axis="z")).surface
    assert np.ptp(result.vertices, axis=0).argmax() == 1


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("scale", [1e-160, 1e100, 1e200, 1e307])
def test_coordinates_of_any_size_make_the_same_surface_without_a_warning(scale):
    box = trimesh.creation.box((1, 1, 1))
    model = Model("box", "box")
    wanted = prepare_object(model, (box.vertices, box.faces), MeshParameters()).surface
    found = prepare_object(model, (scale * box.vertices, box.faces), MeshParameters()).surface
    np.testing.assert_array_equal(found.vertices, wanted.vertices)
    assert found.notes == wanted.notes


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "node",
    [
        {"matrix": [1e308] * 16},
        {"scale": [1e308] * 3, "translation": [1e308] * 3, "rotation": [0, 1, 0, 0]},
    ],
)
def test_transforms_that_overflow_are_refused_without_a_warning(node):
    file = Gltf()
    data = io.BytesIO(file.show({"mesh": file.mesh(), **node}).text())
    data.name = "cube.gltf"
    with pytest.raises(MeshError, match=r"cube has .* NaN or infinite vertices, the first"):
        prepare_object(Model("cube", "cube"), data, MeshParameters())


def ball_with_a_face_at(distance):
    ball = trimesh.creation.icosphere(2)
    stray = [[distance, 0, 0], [distance + 0.001, 0, 0], [distance, 0.001, 0]]
    points = np.concatenate([ball.vertices, stray])
    return build_plain_surface(points, [*ball.faces, [162, 163, 164]])


def test_stray_faces_that_decide_the_size_are_noted():
    near, far, farthest = (
        normalise(ball_with_a_face_at(d), "a.off").surface for d in (5, 1e3, 1e6)
    )
    assert near.notes == ()
    says = "a.off is 1,000 times as large as the part with nearly all its area, because of 1 of 321 faces"
    assert far.notes == (f"{says}; delete stray faces.",)
    assert len(far.faces) == 321
    assert len(farthest.faces) < 100
    assert "because of 1 of 321 faces" in farthest.notes[0]
    assert farthest.notes[1].startswith("a.off lost 2")
    assert "of 321 faces, which are smaller than 1e-06 of its radius" in farthest.notes[1]


def test_a_surface_whose_faces_all_vanish_by_merging_is_refused_with_the_reason():
    says = "a.off lost 32. of 321 faces, which are smaller than 1e-06 of its radius; load parts"
    with pytest.raises(MeshError, match=says):
        normalise(ball_with_a_face_at(1e8), "a.off")


def test_faces_that_are_twice_or_have_no_area_are_dropped_without_a_note(lopsided):
    faces = np.concatenate([lopsided.faces, lopsided.faces[:, ::-1], lopsided.faces[:, [0, 0, 1]]])
    doubled = Surface(lopsided.vertices, faces, np.tile(lopsided.face_colours, (3, 1)))
    assert normalise(doubled, "a.off").surface.notes == ()


def test_a_model_of_the_catalogue_keeps_its_notes_only(tmp_path):
    surface = ball_with_a_face_at(1e3)
    for name, notes in (("a.ply", 1), ("a.ply.gz", 0)):
        write_surface(surface, tmp_path / name)
        made = prepare_object(Model("ball", "a"), tmp_path / name, MeshParameters()).surface
        assert len([note for note in made.notes if "stray" in note]) == notes
