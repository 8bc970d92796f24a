"""Model files of every kind are read with their colours, and broken ones are named."""

import json

import numpy as np
import pytest
import trimesh
from meshes import generated
from meshes.generated import BOARD, write_square
from PIL import Image

from visuohaptic.errors import MeshError
from visuohaptic.meshes.in_memory import GREY
from visuohaptic.meshes.model_files import read_model


@pytest.mark.parametrize("image", ["", "map_Kd gone.png\n", "map_Kd ../secret.png\n"])
def test_a_material_gives_its_diffuse_colour_where_its_image_is_not_there_or_outside(
    tmp_path, image
):
    Image.fromarray(BOARD).save(tmp_path / "secret.png")
    (tmp_path / "models").mkdir()
    surface = read_model(write_square(tmp_path / "models", material=f"Kd 1 0.5 0\n{image}"))
    np.testing.assert_allclose(surface.face_colours, [[255, 128, 0]] * 2, atol=1)
    assert surface.texture is None


def test_vertex_colours_are_averaged_over_the_corners(tmp_path):
    mesh = trimesh.Trimesh(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
        [[0, 1, 2]],
        vertex_colors=[[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255]],
        process=False,
    )
    mesh.export(tmp_path / "a.ply")
    np.testing.assert_array_equal(read_model(tmp_path / "a.ply").face_colours, [[85, 85, 85]])


def test_a_file_without_colours_is_grey(tmp_path):
    trimesh.creation.box().export(tmp_path / "a.stl")
    assert (read_model(tmp_path / "a.stl").face_colours == GREY).all()


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        ("a.obj", b"", "is empty"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv x y z\nf 1 2 3\n", "can't be read as OBJ"),
        ("a.obj", b"v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n", r"has vertices of shape \(3, 2\)"),
        ("a.off", b"hello\n1 2\n", "first line is not OFF"),
        ("a.stl", b"\x00" * 90, "has no faces|can't be read as STL"),
        ("a.xyz", b"0 0 0", "ends in '.xyz'"),
    ],
)
def test_a_broken_file_is_named_with_the_reason(tmp_path, name, content, sentence):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(MeshError, match=sentence) as caught:
        read_model(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(MeshError, match=r"none\.obj can't be read: No such file"):
        read_model(tmp_path / "none.obj")


def test_a_file_above_the_limit_is_refused_before_it_is_read(tmp_path):
    path = write_square(tmp_path)
    with pytest.raises(MeshError, match=r"meshes\.largest_megabytes"):
        read_model(path, largest_megabytes=1e-6)


@pytest.mark.parametrize(
    ("address", "says"),
    [
        ("../secret.bin", "refers to '../secret.bin', which is outside its folder"),
        ("/etc/passwd", "refers to '/etc/passwd', which is not there|outside its folder"),
        ("http://localhost/a.bin", "'http://localhost/a.bin', which is outside its folder"),
        ("gone.bin", "refers to 'gone.bin', which is not there"),
        ("link.bin", "refers to 'link.bin', which is outside its folder"),
    ],
)
def test_a_buffer_outside_the_folder_is_refused_in_the_users_terms(tmp_path, address, says):
    (tmp_path / "models").mkdir()
    document, data = generated.gltf_parts([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    document["buffers"][0]["uri"] = address
    path = tmp_path / "models" / "mug.gltf"
    path.write_text(json.dumps(document))
    (tmp_path / "secret.bin").write_bytes(data)
    (path.parent / "link.bin").symlink_to(tmp_path / "secret.bin")
    with pytest.raises(MeshError, match=says) as caught:
        read_model(path)
    assert "Resolver" not in str(caught.value)
