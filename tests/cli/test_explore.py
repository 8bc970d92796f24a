"""`visuohaptic touch` and `recognise` on any mesh file, and on what is none."""

import json
import re
from pathlib import Path

import pytest
import trimesh
from cli import processes
from cli.models import SMALL, fit_on_nonsense

from visuohaptic.cli.main import run
from visuohaptic.studies.learning_policies import LEARNING_POLICIES
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.schemas import SCHEMAS


@pytest.fixture
def small(tmp_path):
    (tmp_path / "small.yaml").write_text(json.dumps(SMALL))
    return ("--params", "small.yaml")


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    return fit_on_nonsense(tmp_path_factory.mktemp("model"))


def ring(path):
    trimesh.creation.torus(1, 0.4, 16, 8).export(path)
    return path


SHAPES = trimesh.Scene([trimesh.creation.torus(1, 0.4, 16, 8), trimesh.creation.icosphere(1, 0.4)])


@pytest.mark.parametrize("name", ["with_parts.obj", "CAPITALS.GLB"])
def test_a_mesh_file_is_touched(visuohaptic, small, tmp_path, name):
    SHAPES.export(tmp_path / name)
    ended = visuohaptic("touch", name, *small, "--out", "felt")
    assert (ended.code, ended.err) == (0, "")
    assert ended.out.startswith(f"{name}: 10 touches from 2 viewpoints by fixation\n")
    assert re.match(r"10 touches in \d+\.\d s \(prepare ", ended.out.splitlines()[-1])
    for table in ("views", "fixations", "touches", "effects", "features"):
        assert read_table(SCHEMAS[table], tmp_path / "felt" / f"{table}.parquet").num_rows
    asked = "--strategy", "random", "--out", "felt", "--json"
    values = json.loads(visuohaptic("touch", name, *small, *asked).out)
    assert (values["strategy"], values["viewpoints"], values["touches"]) == ("random", 2, 10)
    assert len(values["features"]) == 10
    assert {"x", "contourlet_16", "contact_state"} <= set(values["features"][0])
    assert all(Path(file).is_file() for file in values["files"])
    ended = visuohaptic("touch", name, *small, "--strategy", "seek_relief", "--out", "felt")
    assert ended.out.startswith(f"{name}: 10 touches from 2 viewpoints by seek_relief\n")
    assert "choose" in ended.out.splitlines()[-1]


def test_a_missing_material_and_the_axis_of_the_file_are_said_once(
    visuohaptic, small, tmp_path, model
):
    (tmp_path / "a.obj").write_text(f"mtllib gone.mtl\n{ring(tmp_path / 'ring.obj').read_text()}")
    for verb in (("touch", *small), ("recognise", "--model", model)):
        ended = visuohaptic(verb[0], "a.obj", *verb[1:])
        assert (ended.code, ended.err) == (0, "")
        assert ended.out.count("note: a.obj refers to 'gone.mtl', which is not there") == 1
        assert ended.out.count("note: a.obj is taken as y-up") == 1
        assert ended.out.count("with z up; if so, pass --up z.") == 1
    notes = json.loads(visuohaptic("touch", "a.obj", *small, "--up", "y", "--json").out)["notes"]
    assert ["gone.mtl" in note for note in notes] == [True]


def test_touch_takes_settings_beside_the_file(visuohaptic, small, tmp_path):
    trimesh.creation.box((1, 2, 3)).export(tmp_path / "box.stl")
    settings = ("--set", "sensor.resolution=16", "--set", "attention.fixations=2")
    ended = visuohaptic("touch", "box.stl", *small, *settings, "--out", "felt")
    assert (ended.code, ended.err) == (0, "")
    touches = read_table(SCHEMAS["touches"], tmp_path / "felt/touches.parquet")
    assert touches.num_rows == 4
    assert len(touches["image"][0].as_py()) == 16 * 16
    ended = visuohaptic("touch", "box.stl", *small, "--set", "sensor.resoluton=16")
    assert (ended.code, ended.out) == (1, "")
    assert ended.err == (
        "error: --set: sensor.resoluton is no parameter; did you mean sensor.resolution?\n"
    )


def test_up_and_front_are_axes_of_the_file_and_perpendicular(visuohaptic, small, tmp_path, model):
    trimesh.creation.box((1, 2, 3)).export(tmp_path / "box.stl")
    axes = ("--up", "-z", "--front", "x")
    ended = visuohaptic("touch", "box.stl", *small, *axes, "--json")
    assert (ended.code, ended.err) == (0, "")
    values = json.loads(ended.out)
    assert (values["up"], values["front"]) == ("-z", "x")
    asked = visuohaptic("recognise", "box.stl", "--model", model, *axes, "--viewpoints", 1)
    assert (asked.code, asked.err) == (0, "")
    ended = visuohaptic("touch", "box.stl", *small, "--up", "x", "--front", "-x")
    assert (ended.code, ended.out) == (1, "")
    assert ended.err == "error: up is x and front is -x; perpendicular axes are needed.\n"


def test_recognise_names_an_object_that_was_in_no_training_set(visuohaptic, tmp_path, model):
    ended = visuohaptic("recognise", ring(tmp_path / "ring.obj"), "--model", model, "--json")
    values = json.loads(ended.out)
    assert values["class"] in {"class0", "class1", "unknown"}
    assert sum(values["probabilities"].values()) == pytest.approx(1)
    assert values["touches"] == len(values["touched"]) == 10
    assert values["class"] in values["candidates"]
    assert values["coverage"] == 0.9
    assert values["unknown"] is None
    assert (values["compared"], values["novelty_rank"]) == (4, pytest.approx(0.8))
    assert list(values["turned"]) == ["90", "180", "270"]
    said = visuohaptic("recognise", "ring.obj", "--model", model, "--viewpoints", 1)
    assert (said.code, said.err) == (0, "")
    assert "5 touches from 1 viewpoints by fixation" in said.out
    assert re.match(r"5 touches in \d+\.\d s \(", said.out.splitlines()[-1])
    line = said.out.splitlines()[0]
    assert re.fullmatch(
        r"ring.obj: class\d, \d+\.\d %; one of: class\d(, class\d)? \(right for at least 90 % of objects like the "
        r"known ones\)",
        line,
    )
    assert "  note: 4 known objects are too few to call an object unknown (29 are" in said.out
    assert "an object of another class also gets one of these classes" in said.out


def test_recognise_says_that_a_quarter_turn_changes_the_class(
    visuohaptic, tmp_path, model, monkeypatch
):
    monkeypatch.setattr(
        "visuohaptic.exploration.exploring.classes_when_turned", lambda *_: {90: "a cup"}
    )
    asked = ("recognise", ring(tmp_path / "ring.obj"), "--model", model, "--viewpoints", 1)
    note = "Turned about the vertical the answer is a cup (by 90 degrees): the model takes"
    assert f"  note: {note}" in visuohaptic(*asked).out
    values = json.loads(visuohaptic(*asked, "--json").out)
    assert values["turned"] == {"90": "a cup"}
    assert values["remarks"][-1].startswith(note)


def test_recognise_with_a_model_of_enough_objects_calls_a_far_object_unknown(visuohaptic, tmp_path):
    asked = ("--model", fit_on_nonsense(tmp_path / "many", objects=(15, 15)), "--viewpoints", 1)
    said = visuohaptic("recognise", ring(tmp_path / "ring.obj"), *asked)
    assert re.match(
        r".*ring.obj: unknown; farther out than 30 of 30 known objects; the nearest known class is class\d\n",
        said.out,
    )
    assert "lies farther out than nearly all of these is called unknown" in said.out
    assert "too few" not in said.out


def test_recognise_says_by_which_strategies_the_model_learnt_if_not_by_this_one(
    visuohaptic, tmp_path, model
):
    asked = ("recognise", ring(tmp_path / "ring.obj"), "--model", model, "--viewpoints", 1)
    sentence = (
        "The model learnt from touches by fixation and these touches were made by seek_relief, so"
    )
    ended = visuohaptic(*asked, "--strategy", "seek_relief")
    assert (ended.code, ended.err) == (0, "")
    assert f"  caution: {sentence}" in ended.out
    assert "5 touches from 1 viewpoints by seek_relief" in ended.out
    assert "an object of another class also gets one of these classes" in ended.out
    values = json.loads(visuohaptic(*asked, "--strategy", "seek_relief", "--json").out)
    assert values["caution"].startswith(sentence)
    assert (values["strategy"], values["learnt_strategies"]) == ("seek_relief", ["fixation"])
    assert values["candidates"] is values["coverage"] is values["unknown"] is None
    values = json.loads(visuohaptic(*asked, "--json").out)
    assert (values["strategy"], values["caution"]) == ("fixation", None)
    ended = visuohaptic(*asked, "--strategy", "nowhere")
    assert ended.code == 2
    assert "'nowhere' is no strategy of touch" in ended.err


@pytest.mark.parametrize("command", ["touch", "recognise"])
def test_a_learning_policy_of_ones_own_is_told_where_it_is_used(
    visuohaptic, tmp_path, monkeypatch, command
):
    monkeypatch.setattr(LEARNING_POLICIES, "_entries", {"in_order": None})
    ended = visuohaptic(command, ring(tmp_path / "ring.obj"), "--strategy", "in_order")
    assert ended.code == 2
    said = " ".join(ended.err.split())
    assert "'in_order' is no strategy of touch; only study touch_curves can use it (`touch" in said


def test_without_a_model_of_a_run_the_packages_is_taken(visuohaptic, tmp_path):
    ended = visuohaptic("recognise", ring(tmp_path / "ring.obj"), "--viewpoints", 1, "--json")
    values = json.loads(ended.out)
    assert values["model"].endswith("visuohaptic/exploration/recogniser.skops")
    assert {"bottle", "car", "chair", "cup", "quadruped"} < set(values["probabilities"])


def test_an_unforeseen_error_is_a_sentence_and_debug_shows_where(
    visuohaptic, tmp_path, monkeypatch
):
    def fail(*_, **__):
        raise ZeroDivisionError("of a kind")

    monkeypatch.setattr("visuohaptic.exploration.exploring.load", fail)
    ended = visuohaptic("touch", "ring.obj")
    assert ended.code == 1
    assert ended.err.startswith("error: ZeroDivisionError: of a kind; `visuohaptic --debug")
    with pytest.raises(ZeroDivisionError):
        run(["touch", "ring.obj", "--debug"])


def test_several_meshes_are_touched_into_a_folder_each_and_a_broken_one_is_named(
    visuohaptic, small, tmp_path
):
    for name in ("a.obj", "b.ply"):
        ring(tmp_path / name)
    ended = visuohaptic("touch", "a.obj", "b.ply", *small, "--out", "felt")
    assert ended.code == 0, ended.err
    assert {path.parent.name for path in tmp_path.rglob("touches.parquet")} == {"a", "b"}
    (tmp_path / "c.obj").write_text("nothing")
    ended = visuohaptic("touch", "c.obj", "a.obj", "b.ply", *small, "--json")
    assert [value["mesh"] for value in json.loads(ended.out)] == ["a.obj", "b.ply"]
    assert ended.code == 1
    assert ended.err.startswith("error: c.obj can't be read as OBJ: it has no faces; ")
    assert not (tmp_path / "touched" / "c").exists()


@pytest.mark.slow
@pytest.mark.parametrize("arguments", [["--help"], ["touch", "ring.obj", "--params", "small.yaml"]])
def test_a_closed_pipe_is_no_error(tmp_path, small, arguments):
    ring(tmp_path / "ring.obj")
    process = processes.start(arguments, tmp_path)
    process.stdout.close()
    assert process.stderr.read() == ""
    process.stderr.close()
    assert process.wait() == 0


@pytest.mark.slow
def test_the_shell_completes_commands_and_options(tmp_path):
    def offered(*words):
        asked = {
            "_VISUOHAPTIC_COMPLETE": "complete_bash",
            "COMP_WORDS": " ".join(("visuohaptic", *words)),
            "COMP_CWORD": str(len(words)),
        }
        return processes.run([], tmp_path, **asked)[1].split()

    assert offered("tou") == ["touch"]
    assert offered("touch", "--strategy", "farth") == ["farthest_point"]
    assert set(offered("meshes", "")) == {"fetch", "check", "credits"}
