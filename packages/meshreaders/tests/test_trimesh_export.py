"""A mesh of trimesh has the triangles, colours and images of the mesh that it comes from."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from mesh_files.generated import BOARD, write_square

import meshreaders
from meshreaders import trimesh_export
from meshreaders.base.texture import CLAMP, MIRROR, Texture

POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1]])
FACES = np.array([[0, 1, 2], [0, 2, 3], [0, 1, 4], [3, 0, 4]])
COLOURS = np.array([[9, 8, 7], [1, 2, 3], [250, 0, 0], [0, 250, 0]], np.uint8)


@pytest.fixture
def plain():
    return meshreaders.Mesh(POINTS, FACES, COLOURS, notes=("a note.",))


def painted(mesh, image):
    """Return a mesh whose faces have the images of these indices; texture coordinates differ by face."""
    generator = np.random.default_rng(0)
    images = tuple(generator.integers(0, 256, (4, 6, 3), np.uint8) for _ in range(2))
    corners = generator.uniform(0, 1, (len(FACES), 3, 2)).astype(np.float32)
    texture = Texture(
        corners,
        np.array(image, np.int32),
        images,
        np.array([[CLAMP, MIRROR], [MIRROR, CLAMP]], np.uint8),
    )
    colours = np.where(texture.textured[:, None], texture.face_colours(), COLOURS)
    return replace(mesh, texture=texture, face_colours=colours)


def test_colours_of_faces_come_back(plain):
    converted = meshreaders.to_trimesh(plain)
    assert isinstance(converted, trimesh.Trimesh)
    assert converted.metadata["notes"] == ["a note."]
    np.testing.assert_array_equal(converted.visual.face_colors[:, :3], COLOURS)
    back = meshreaders.read(converted)
    np.testing.assert_array_equal(back.triangles, plain.triangles)
    np.testing.assert_array_equal(back.face_colours, COLOURS)


@pytest.mark.parametrize(
    ("image", "kind", "order"),
    [
        ([1, 1, 1, 1], trimesh.Trimesh, [0, 1, 2, 3]),
        ([1, 0, 1, 0], trimesh.Scene, [1, 3, 0, 2]),
        ([0, -1, 1, -1], trimesh.Scene, [1, 3, 0, 2]),
    ],
    ids=["one image", "two images", "faces without an image"],
)
def test_images_come_back_with_their_places_and_ends(plain, image, kind, order):
    mesh = painted(plain, image)
    converted = meshreaders.to_trimesh(mesh)
    assert isinstance(converted, kind)
    back = meshreaders.read(converted)
    np.testing.assert_array_equal(back.triangles, mesh.triangles[order])
    np.testing.assert_array_equal(back.face_colours, mesh.face_colours[order])
    wanted, found = mesh.texture, back.texture
    textured = wanted.image[order] >= 0
    np.testing.assert_array_equal(found.textured, textured)
    np.testing.assert_array_equal(found.corners[textured], wanted.corners[order][textured])
    for face in np.flatnonzero(textured):
        here, there = found.image[face], wanted.image[order][face]
        np.testing.assert_array_equal(found.images[here], wanted.images[there])
        np.testing.assert_array_equal(found.wraps[here], wanted.wraps[there])


def test_corners_of_equal_places_share_a_vertex(tmp_path):
    square = meshreaders.read(write_square(tmp_path, BOARD))
    assert len(meshreaders.to_trimesh(square).vertices) == 4


def test_without_trimesh_a_sentence_says_how_to_install_it(plain, monkeypatch):
    monkeypatch.setattr(trimesh_export, "find_spec", lambda _: None)
    with pytest.raises(
        meshreaders.MissingPackageError, match=r"pip install 'meshreaders\[trimesh\]'"
    ):
        meshreaders.to_trimesh(plain)
