"""An object from its file to its name, the same as the workflow finds."""

import ast
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
import trimesh
from cli.models import fit_on_nonsense
from phases_by_files import run_phases

import visuohaptic as vh
from visuohaptic.base.errors import MeshError, ParameterError, RecognitionError
from visuohaptic.evaluation.summary import select
from visuohaptic.exploration.recognising import check_compatible
from visuohaptic.meshes.catalogue import read_catalogue
from visuohaptic.meshes.files import make_mesh
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.stored_models import load_model, save_model

ROOT = Path(__file__).parents[2]
SMALL = ExperimentParameters.from_mapping(
    {"rendering": {"resolution": 64}, "viewpoints": {"count": 10}, "scene": {"preset": "worn_fsr"}}
)


@pytest.fixture(scope="module")
def ring_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("ring") / "ring.obj"
    trimesh.creation.torus(1, 0.4, 16, 8).export(path)
    return path


@pytest.mark.slow
def test_tables_of_a_shipped_object_are_those_of_the_workflow(tmp_path):
    """With a worn sensor too, whose chance hangs on the object's key."""
    key = "bottle/sc_com_bath2_jabon_pijo"
    source = ROOT / "meshes" / "paper" / f"{key}.ply.gz"
    models = {model.key: model for model in read_catalogue(ROOT / "meshes/catalogue.csv")}
    make_mesh(key, models[key], source, tmp_path / "mesh.ply", SMALL.meshes)
    expected = run_phases(key, tmp_path / "mesh.ply", tmp_path, SMALL)
    for strategy in ("fixation", "random"):
        found = vh.load(source).touch(strategy=strategy, parameters=SMALL)
        assert found.key == key
        assert found.views.equals(expected["views"])
        for name in ("fixations", "touches", "features"):
            assert getattr(found, name).equals(select(expected[name], strategy=strategy))


def test_one_line_from_a_file_to_a_table(ring_file):
    found = vh.load(ring_file).touch(viewpoints=3, parameters=SMALL)
    assert found.key == "unknown/ring"
    assert found.features.num_rows == 15
    assert found.parameters.viewpoints.count == 3
    assert set(found.seconds) == {"prepare", "look", "touch", "describe"}
    with pytest.raises(ParameterError, match=r"^touch: sensor\.resolution is 34"):
        vh.load(ring_file).touch(parameters={"sensor.resolution": 34})
    with pytest.raises(MeshError, match="'ring' is no key"):
        vh.load(ring_file, key="ring")


def test_touches_with_other_parameters_than_the_models_are_refused_whatever_the_strategy(ring_file):
    there = ExperimentParameters.from_mapping({"sensor": {"resolution": 16}})
    recogniser = vh.Recogniser(SimpleNamespace(strategies=("fixation",)), there)
    ring = vh.load(ring_file)
    places = ring.surface.vertices[:1]
    for made in (ring.touch(1, "random", SMALL), ring.touch(at=places, parameters=SMALL)):
        with pytest.raises(RecognitionError, match=r"sensor.resolution 32 \(the model's is 16\)"):
            made.recognise(recogniser)


def test_a_frame_that_is_not_the_models_is_refused_where_it_was_asked_for(tmp_path):
    fit_on_nonsense(tmp_path)
    recogniser = vh.read_recogniser(tmp_path / "recogniser.skops")
    touched = recogniser.parameters
    own = RecognitionParameters(frame="none")
    of_none = replace(recogniser, model=replace(recogniser.model, parameters=own))

    def asked(frame):
        return touched.model_copy(update={"recognition": RecognitionParameters(frame=frame)})

    sentence = r"^recognition\.frame is none, and the model was fitted for full; "
    with pytest.raises(RecognitionError, match=sentence):
        check_compatible(asked("none"), recogniser)
    with pytest.raises(RecognitionError, match="is full, and the model was fitted for none"):
        check_compatible(asked("full"), of_none)
    check_compatible(asked("none"), of_none)
    # A frame that nobody asked for is the model's.
    check_compatible(touched, of_none)


def test_the_frame_that_was_asked_for_reaches_the_model(tmp_path, ring_file):
    fit_on_nonsense(tmp_path)
    recogniser = vh.read_recogniser(tmp_path / "recogniser.skops")
    learnt = recogniser.parameters.model_dump(exclude={"recognition"}, exclude_unset=True)
    asked = {**learnt, "recognition": {"frame": "none"}}
    made = vh.load(ring_file, parameters={"meshes.own_up_axis": "y"}).touch(
        1, recogniser.model.strategies[0], asked
    )
    with pytest.raises(RecognitionError, match="frame is none, and the model was fitted for full"):
        made.recognise(recogniser)


def test_a_model_that_does_not_say_how_its_touches_were_made_is_refused(tmp_path):
    fit_on_nonsense(tmp_path)
    path = tmp_path / "recogniser.skops"
    assert vh.read_recogniser(path).parameters.viewpoints.count == 2
    save_model(replace(load_model(path), touching=None), path)
    with pytest.raises(RecognitionError, match="lacks the parameters of its training touches"):
        vh.read_recogniser(path)


def test_what_the_package_offers_is_what_its_stub_names():
    stub = ast.parse((ROOT / "src/visuohaptic/__init__.pyi").read_text())
    names = {
        alias.asname
        for node in stub.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert names == set(vh.__all__)
    assert all(getattr(vh, name) for name in names)


def test_a_needle_is_touched_and_drawn_though_some_views_show_no_place(tmp_path):
    needle = trimesh.creation.cylinder(0.004, 2)
    found = vh.load(needle, key="tool/needle").touch(viewpoints=9, parameters=SMALL)
    shown = set(found.touches.column("viewpoint").to_pylist())
    assert 0 < len(shown) < found.views.num_rows == 9
    assert all(file.is_file() for file in found.save(tmp_path))
