"""Model files of every kind are read with their colours, whatever they refer to stays in their folder."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import trimesh
from meshes.generated import BOARD, FACES, POINTS, SQUARE, as_gltf, write_square
from PIL import Image

import visuohaptic as vh
from visuohaptic.base.errors import MeshError, MeshWarning
from visuohaptic.geometry.surface import notes_of
from visuohaptic.meshes.files import make_mesh
from visuohaptic.meshes.model_files import read_mesh
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.parts import GREY
from visuohaptic_workflow import closing
from visuohaptic_workflow.closing import lines_at_end


@pytest.mark.parametrize("image", ["", "map_Kd gone.png\n", "map_Kd ../secret.png\n"])
def test_a_material_gives_its_diffuse_colour_where_its_image_is_not_there_or_outside(
    tmp_path, image
):
    Image.fromarray(BOARD).save(tmp_path / "secret.png")
    (tmp_path / "models").mkdir()
    surface = read_mesh(write_square(tmp_path / "models", material=f"Kd 1 0.5 0\n{image}"))
    np.testing.assert_allclose(surface.face_colours, [[255, 128, 0]] * 2, atol=1)
    assert surface.texture is None


def test_what_a_file_names_and_is_not_there_is_one_note_and_a_warning_of_load(tmp_path):
    path = write_square(
        tmp_path, material="Kd 1 0.5 0\nmap_Kd gone.png\n", text="mtllib b.mtl\n" + SQUARE
    )
    (note,) = read_mesh(path).notes
    assert note.startswith(f"{path} refers to ")
    assert "'b.mtl', which is not there" in note
    assert "'gone.png', which is not there" in note
    with pytest.warns(MeshWarning) as warned:
        surface = vh.load(path, parameters={"own_up_axis": "y"}).surface
    assert [str(one.message) for one in warned] == [note] == list(surface.notes)


def test_the_mesh_file_of_an_own_model_has_its_notes_and_a_run_says_them_at_its_end(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    path = write_square(tmp_path, text="mtllib b.mtl\n" + SQUARE)
    make_mesh(
        "cup/a", None, path, "results/meshes/cup/a/cup/a.ply", MeshParameters(own_up_axis="y")
    )
    (note,) = notes_of("results/meshes/cup/a/cup/a.ply")
    assert "'b.mtl', which is not there" in note
    assert lines_at_end(report_is_current=False) == [f"warning: cup/a: {note}"]
    (line,) = set(lines_at_end(report_is_current=True)) - {f"warning: cup/a: {note}"}
    assert line.startswith("Touched, but not recognised")
    assert line.endswith(": cup/a.")
    shutil.copytree("results/meshes/cup/a", "results/meshes/cup/b")
    Path("results/meshes/cup/b/cup/a.ply").rename("results/meshes/cup/b/cup/b.ply")
    lines = lines_at_end(report_is_current=True)
    assert lines == [f"warning: cup/{name}: {note}" for name in "ab"]
    monkeypatch.setattr(closing, "MOST_LINES", 1)
    first, rest = lines_at_end(report_is_current=True)
    assert first == lines[0]
    assert rest == "Lines of this kind that the report has, but this list has not: 1."


def test_vertex_colours_are_averaged_over_the_corners_and_a_file_without_is_grey(tmp_path):
    mesh = trimesh.Trimesh(POINTS, FACES, vertex_colors=255 * np.eye(3), process=False)
    for suffix, colour in ((".ply", 85), (".stl", GREY)):
        mesh.export(tmp_path / f"a{suffix}")
        found = read_mesh(tmp_path / f"a{suffix}").face_colours
        np.testing.assert_array_equal(found, np.broadcast_to(colour, (1, 3)))


@pytest.mark.parametrize(
    ("name", "sentence"),
    [("empty.obj", "is empty"), ("a.xyz", "ends in '.xyz'"), ("none.obj", "No such file")],
)
def test_a_file_that_is_no_model_is_named_with_the_reason(tmp_path, name, sentence):
    (tmp_path / "empty.obj").touch()
    with pytest.raises(MeshError, match=rf"{name} .*{sentence}"):
        read_mesh(tmp_path / name)


def test_a_file_above_the_limit_is_refused_before_it_is_read(tmp_path):
    path = write_square(tmp_path)
    with pytest.raises(MeshError, match=r"meshes\.largest_megabytes"):
        read_mesh(path, largest_megabytes=1e-6)


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
        return read_mesh(path)

    assert len(refer_to("whole.bin").faces) == 1
    with pytest.raises(MeshError, match=says) as caught:
        refer_to(address)
    assert "Resolver" not in str(caught.value)
