"""An object comes from a file, from a mesh in memory, from arrays, or from an open file."""

import io

import numpy as np
import pytest
import trimesh

import visuohaptic as vh
from visuohaptic.base.errors import MeshError, MeshWarning, ParameterError
from visuohaptic.exploration.examples import examples
from visuohaptic.meshes.parameters import MeshParameters
from visuohaptic.parameters import ExperimentParameters

RING = trimesh.creation.torus(1, 0.4, 16, 8)


@pytest.fixture
def ring_file(tmp_path):
    RING.export(tmp_path / "ring.ply")
    return tmp_path / "ring.ply"


def test_every_kind_of_source_gives_the_same_surface(ring_file):
    expected = vh.load(ring_file).surface
    arrays = (RING.vertices.astype(np.float32), RING.faces)
    lists = tuple(map(np.ndarray.tolist, arrays))
    for source in (trimesh.load(ring_file, process=False), arrays, lists, trimesh.Scene([RING])):
        found = vh.load(source)
        assert found.key == "unknown/object"
        np.testing.assert_allclose(found.surface.vertices, expected.vertices, atol=1e-6)
        assert len(found.surface.faces) == len(expected.faces)


def test_an_open_file_is_read_as_what_it_is_said_to_be(ring_file):
    expected = vh.load(ring_file).surface
    with ring_file.open("rb") as stream:
        found = vh.load(stream)
    assert found.key == "unknown/ring"
    np.testing.assert_array_equal(found.surface.vertices, expected.vertices)
    content = io.BytesIO(ring_file.read_bytes())
    found = vh.load(content, key="cup/mug", file_type="ply")
    assert found.key == "cup/mug"
    np.testing.assert_array_equal(found.surface.vertices, expected.vertices)


@pytest.mark.parametrize(
    ("content", "file_type", "sentence"),
    [
        (io.BytesIO(b"v 0 0 0"), None, r"file_type is needed; obj, ply, .* are allowed"),
        (io.BytesIO(b"v 0 0 0"), "txt", "file_type is 'txt'; obj, ply"),
        (io.StringIO("v 0 0 0"), "obj", 'open it with mode "rb"'),
        (io.BytesIO(), "obj", "is empty"),
    ],
)
def test_an_open_file_needs_a_type_and_bytes(content, file_type, sentence):
    with pytest.raises(MeshError, match=sentence):
        vh.load(content, file_type=file_type)


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        (([[0, 0, 0]], [[0, 0, 0]]), "no area"),
        (([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]), r"vertices of shape \(3, 2\)"),
        (([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]]), "names vertex 3"),
        (([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0.5, 1, 2]]), "faces of float64"),
        (("a", "b"), "numbers are needed"),
        (None, "NoneType; a path, a trimesh.Trimesh"),
        (trimesh.Trimesh(), "no faces"),
    ],
)
def test_what_is_no_surface_is_one_sentence(source, sentence):
    with pytest.raises(MeshError, match=sentence):
        vh.load(source)


def test_a_scene_whose_parts_can_not_be_laid_out_is_one_sentence(monkeypatch):
    monkeypatch.setattr(trimesh.Trimesh, "apply_transform", None)
    with pytest.raises(MeshError, match="object can't be read as a mesh: "):
        vh.load(trimesh.Scene([RING]))


def test_colours_of_a_mesh_in_memory_are_seen():
    red = RING.copy()
    red.visual.face_colors = [255, 0, 0, 255]
    assert (vh.load(red).surface.face_colours == [255, 0, 0]).all()


def test_section_meshes_is_taken_from_whatever_parameters_are_given():
    cone = trimesh.creation.cone(0.3, 2)
    for parameters in (
        {"meshes.own_up_axis": "z"},
        {"own_up_axis": "z"},
        ExperimentParameters.from_mapping({"meshes": {"own_up_axis": "z"}}),
        MeshParameters(own_up_axis="z"),
    ):
        found = vh.load(cone, parameters=parameters).surface
        assert np.argmax(np.ptp(found.vertices, axis=0)) == 1
    with pytest.raises(ParameterError, match=r"meshes\.own_up_axis is 'w'"):
        vh.load(cone, parameters={"own_up_axis": "w"})


def test_up_and_front_are_arguments_that_override_the_parameters():
    cone, way = trimesh.creation.cone(0.3, 2), {"own_up_axis": "z", "own_front_axis": "x"}
    by_parameters = vh.load(cone, parameters=way)
    for found in (
        vh.load(cone, up="z", front="x"),
        vh.load(cone, parameters={"own_up_axis": "x", "own_front_axis": "-z"}, up="z", front="x"),
    ):
        np.testing.assert_array_equal(found.surface.vertices, by_parameters.surface.vertices)
        assert (found.frame.up_axis, found.frame.front_axis) == ("z", "x")
    assert vh.load(cone, up="-z").frame.front_axis == "y"
    assert vh.load(cone, front="-x").frame.up_axis == "y"


@pytest.mark.parametrize(
    ("axes", "sentence"),
    [
        ({"up": "w"}, "up is 'w'; file, auto, x, -x, y, -y, z, -z are allowed."),
        ({"front": "auto"}, "front is 'auto'; x, -x, y, -y, z, -z are allowed."),
        ({"up": "z", "front": "-z"}, "up is z and front is -z; perpendicular axes are needed."),
        (
            {"parameters": {"own_up_axis": "x", "own_front_axis": "-x"}},
            "parameters: meshes: own_up_axis is x and own_front_axis is -x; perpendicular axes are needed.",
        ),
    ],
)
def test_axes_that_are_none_or_are_parallel_are_refused(axes, sentence):
    with pytest.raises(ParameterError) as raised:
        vh.load(trimesh.creation.cone(0.3, 2), **axes)
    assert str(raised.value) == sentence


def test_a_packed_model_takes_no_axes():
    path = next(iter(examples().values()))
    with pytest.raises(ParameterError, match="is a packed model, which has y up"):
        vh.load(path, up="z")


def test_a_doubtful_up_axis_is_told_with_the_argument_of_load():
    with pytest.warns(MeshWarning, match='z up; if so, load the mesh with up="z".'):
        vh.load(trimesh.creation.cone(1, 2))
