"""Models are read with their colours, and whatever they refer to stays in their folder."""

import numpy as np
import pytest
import trimesh
from mesh_files.generated import BOARD, FACES, POINTS, as_gltf, write_square
from PIL import Image

import meshreaders
from meshreaders.base.errors import MeshError
from meshreaders.command import describe
from meshreaders.parts import GREY


@pytest.mark.parametrize("image", ["", "map_Kd gone.png\n", "map_Kd ../secret.png\n"])
def test_a_material_gives_its_diffuse_colour_where_its_image_is_not_there_or_outside(
    tmp_path, image
):
    Image.fromarray(BOARD).save(tmp_path / "secret.png")
    (tmp_path / "models").mkdir()
    surface = meshreaders.read(write_square(tmp_path / "models", material=f"Kd 1 0.5 0\n{image}"))
    np.testing.assert_allclose(surface.face_colours, [[255, 128, 0]] * 2, atol=1)
    assert surface.texture is None


def test_vertices_of_faces_that_are_no_places_are_counted_in_a_note(tmp_path):
    points = [*POINTS, [np.nan, 0, 0], [0, np.inf, 0], [np.nan, 0, 0]]
    text = "".join(f"v {x} {y} {z}\n" for x, y, z in points) + "f 1 2 3\nf 1 4 5\n"
    (tmp_path / "a.obj").write_text(text)
    assert meshreaders.read(tmp_path / "a.obj").notes == (
        f"{tmp_path / 'a.obj'} has 2 NaN or infinite vertices.",
    )
    assert [*describe(tmp_path / "a.obj")][-1].endswith("has 2 NaN or infinite vertices.")
    assert meshreaders.read((np.array(points), np.array([[0, 1, 2]]))).notes == ()


def test_vertex_colours_are_averaged_over_the_corners_and_a_file_without_is_grey(tmp_path):
    mesh = trimesh.Trimesh(POINTS, FACES, vertex_colors=255 * np.eye(3), process=False)
    for suffix, colour in ((".ply", 85), (".stl", GREY)):
        mesh.export(tmp_path / f"a{suffix}")
        found = meshreaders.read(tmp_path / f"a{suffix}").face_colours
        np.testing.assert_array_equal(found, np.broadcast_to(colour, (1, 3)))


@pytest.mark.parametrize(
    ("address", "says"),
    [
        ("../secret.bin", "outside its folder"),
        ("/etc/passwd", "not there|outside its folder"),
        ("http://localhost/a.bin", "outside its folder"),
        ("link.bin", "outside its folder"),
        ("cut.bin", "truncated"),
    ],
)
def test_a_buffer_that_is_cut_not_there_or_outside_the_folder_is_refused(tmp_path, address, says):
    scene = trimesh.Scene(trimesh.Trimesh(POINTS, FACES))
    data = trimesh.exchange.gltf.export_gltf(scene, merge_buffers=True)["gltf_buffer.bin"]
    (tmp_path / "models").mkdir()
    (tmp_path / "secret.bin").write_bytes(data)
    (tmp_path / "models/link.bin").symlink_to(tmp_path / "secret.bin")
    (tmp_path / "models/cut.bin").write_bytes(data[:-1])
    (tmp_path / "models/whole.bin").write_bytes(data)
    path = tmp_path / "models/mug.gltf"

    def refer_to(address):
        buffers = [{"uri": address, "byteLength": len(data)}]
        path.write_bytes(as_gltf(POINTS, FACES, buffers=buffers))
        return meshreaders.read(path)

    assert len(refer_to("whole.bin").faces) == 1
    with pytest.raises(MeshError, match=says) as caught:
        refer_to(address)
    assert "Resolver" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "sentence"),
    [("empty.obj", "is empty"), ("a.xyz", "ends in '.xyz'"), ("none.obj", "No such file")],
)
def test_a_file_that_is_no_model_is_named_with_the_reason(tmp_path, name, sentence):
    (tmp_path / "empty.obj").touch()
    with pytest.raises(MeshError, match=rf"{name} .*{sentence}"):
        meshreaders.read(tmp_path / name)


def test_a_file_above_the_limit_is_refused_before_it_is_read(tmp_path):
    with pytest.raises(meshreaders.TooLargeError, match=r"allowed \(largest_megabytes\)"):
        meshreaders.read(write_square(tmp_path), largest_megabytes=1e-6)


def test_parts_are_read_one_by_one_with_the_notes(tmp_path):
    path = write_square(tmp_path, text="mtllib a.mtl b.mtl\n" + TWO)
    given = meshreaders.read_parts(path)
    assert [len(part.faces) for part in given.parts] == [1, 1]
    assert given.notes == meshreaders.read(path).notes
    assert "'b.mtl', which is not there" in given.notes[0]


TWO = "v 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl paint\nf 1 2 3\nusemtl other\nf 1 3 2\n"
