"""Models and meshes in memory become surfaces; what is wrong with them is said by this package's errors."""

import gzip
import io
import shutil
import tracemalloc
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from zipfile import ZipFile

import numpy as np
import pytest
from mesh_files.generated import BOARD, FACES, POINTS, SQUARE, as_obj, as_ply, packed, write_square

import meshreaders
import visuohaptic as vh
from visuohaptic.base.errors import MeshError, MeshWarning
from visuohaptic.exploration.pressing import press
from visuohaptic.geometry.surface import Surface, notes_of
from visuohaptic.meshes.catalogue import Model
from visuohaptic.meshes.files import make_mesh
from visuohaptic.meshes.model_files import read_mesh, surface_from_archive
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.meshes.preparing import prepare_object
from visuohaptic_workflow import closing
from visuohaptic_workflow.closing import lines_at_end


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


SQUARE_POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
SQUARE_FACES = np.array([[0, 1, 2], [0, 2, 3]])


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


def test_a_surface_and_a_mesh_of_open3d_are_sources(tmp_path):
    surface = read_mesh((SQUARE_POINTS, SQUARE_FACES))
    assert isinstance(surface, Surface)
    assert read_mesh(surface) is surface
    import_module("visuohaptic.geometry.compiled_open3d")
    open3d = import_module("open3d")
    vector = open3d.utility
    mesh = open3d.geometry.TriangleMesh(
        vector.Vector3dVector(SQUARE_POINTS), vector.Vector3iVector(SQUARE_FACES)
    )
    for form in (mesh, open3d.t.geometry.TriangleMesh.from_legacy(mesh), surface):
        assert press(form, [[0.5, 0.5, 0]], [[0, 0, 1]], 0.1, resolution=4).images.min() == 1


def test_a_surface_goes_to_trimesh_and_back(tmp_path):
    surface = vh.load(write_square(tmp_path, BOARD), up="y").surface
    back = read_mesh(meshreaders.to_trimesh(surface))
    np.testing.assert_array_equal(back.triangles, surface.triangles)
    np.testing.assert_array_equal(back.face_colours, surface.face_colours)
    np.testing.assert_array_equal(back.texture.images, surface.texture.images)
    np.testing.assert_array_equal(back.texture.corners, surface.texture.corners)


def test_a_mesh_of_pyvista_is_loaded_as_one_object():
    data = type("Data", (dict,), {"active_scalars_name": None})
    mesh = SimpleNamespace(
        points=SQUARE_POINTS, faces=np.array([4, 0, 1, 2, 3]), strips=(),
        cell_data=data(RGB=np.array([[9, 8, 7]], np.uint8)), point_data=data(),
    )  # fmt: skip
    surface = vh.load(mesh, up="y").surface
    np.testing.assert_array_equal(surface.face_colours, [[9, 8, 7]] * 2)


@pytest.mark.parametrize("source", [7, (np.array(POINTS) * 1j, FACES), "a.stl", io.BytesIO(b"?")])
def test_what_the_readers_refuse_is_an_error_of_this_package_with_the_same_sentence(
    tmp_path, monkeypatch, source
):
    monkeypatch.chdir(tmp_path)
    Path("a.stl").write_bytes(b"no solid")
    kind = "obj" if hasattr(source, "read") else None
    with pytest.raises(meshreaders.MeshError) as told:
        meshreaders.read(source, kind)
    if kind:
        source.seek(0)
    with pytest.raises(MeshError) as raised:
        read_mesh(source, kind)
    assert str(raised.value) == str(told.value)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("text.ply.gz", gzip.compress(as_ply(np.array(POINTS), FACES, "ascii")), "its rows are text; binary rows are needed"),
        ("bomb.ply.gz", gzip.compress(bytes(60_000_000), 9), "unpacks to more than 50 MB"),
    ],
)  # fmt: skip
def test_a_hostile_packed_surface_is_named_and_takes_little_memory(tmp_path, name, content, says):
    path = tmp_path / name
    path.write_bytes(content)
    tracemalloc.start()
    with pytest.raises(MeshError, match=says) as caught:
        prepare_object(Model("a", "b"), path, MeshParameters(largest_megabytes=50))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 500
    assert peak < 100e6


# A closed solid of a pentagon that is not flat, and of five triangles to an apex.
SOLID = [[-5, 0, 5], [5, 0, 5], [5, 0, -5], [-5, 0, -5], [0, 5, -5], [0, -6, 0]]
SIDES = [[0, 1, 2, 3, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [4, 3, 5], [0, 4, 5]]


def test_models_of_the_catalogue_stay_as_they_are_pinned():
    data = packed({"a.obj": as_obj(SOLID, SIDES)})
    with ZipFile(io.BytesIO(data)) as archive:
        assert len(surface_from_archive(archive.read("a.obj"), "a.obj", archive).faces) == 7
