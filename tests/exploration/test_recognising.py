"""Touches by any strategy are recognised, and the answer says where the model did not learn from the strategy."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from cli.models import fit_on_nonsense
from recognition.synthetic import features_table, with_column

import visuohaptic as vh
from visuohaptic.active.registry import STRATEGIES
from visuohaptic.base.errors import MeshError, ParameterError, RecognitionError
from visuohaptic.exploration.quarter_turns import (
    classes_when_turned,
    note_on_front,
    turn_touches,
)
from visuohaptic.exploration.recognising import note_on_few_objects
from visuohaptic.recognition.model import ModelAnswer, fit_model
from visuohaptic.recognition.model_of_run import make_model
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.stored_models import load_model
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import join_parts, write_table

SENTENCE = (
    "The model learnt from touches by fixation and these touches were made {}, so its probabilities are not "
    "calibrated for them and it states no prediction set."
)
PLACES = np.array([[1.0, 0, 0], [0, 1.0, 0], [0, 0, -1.0], [0.6, 0.8, 0]])


@pytest.fixture(scope="module")
def recogniser(tmp_path_factory):
    return vh.read_recogniser(fit_on_nonsense(tmp_path_factory.mktemp("model")))


@pytest.fixture(scope="module")
def ball():
    return vh.load(trimesh.creation.icosphere(4))


def given(ball, recogniser):
    return ball.touch(at=PLACES, parameters=recogniser.parameters)


def one_by_one(ball, recogniser):
    made, _ = ball.touch(at=PLACES[:1], parameters=recogniser.parameters).touch_next(PLACES[1])
    return made


def by(strategy):
    return lambda ball, recogniser: ball.touch(1, strategy, recogniser.parameters)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (given, "at given points"),
        (one_by_one, "at given points"),
        (by("random"), "by random"),
        (by("seek_relief"), "by seek_relief"),
    ],
    ids=["given", "touch_next", "random", "policy"],
)
def test_touches_that_the_model_did_not_learn_from_get_probabilities_and_a_sentence(
    ball, recogniser, make, words
):
    made = make(ball, recogniser)
    found = made.recognise(recogniser)
    assert found.caution == SENTENCE.format(words)
    assert found.caution in repr(found)
    assert found.caution in found._repr_html_()
    assert sum(found.probabilities.values()) == pytest.approx(1)
    assert found.name == next(iter(found.probabilities))
    stated = (found.candidates, found.novelty_rank, found.unknown, found.coverage)
    assert stated == (None, None, None, None)
    assert found.touches == made.touches.num_rows


def test_touches_that_the_model_learnt_from_get_a_prediction_set_and_no_sentence(ball, recogniser):
    found = by("fixation")(ball, recogniser).recognise(recogniser)
    assert found.caution is None
    assert found.coverage == 0.9
    assert set(found.candidates) <= {"class0", "class1"}
    assert found.name == found.candidates[0]
    assert "learnt" not in repr(found)
    phrase = f"one of: {', '.join(found.candidates)} (right for at least 90 % of objects like the known ones)"
    assert f"; {phrase}; from 5 touches" in repr(found)
    assert f"<p>{phrase}</p>" in found._repr_html_()


def test_a_model_of_few_objects_says_that_they_are_too_few_instead_of_unknown(ball, recogniser):
    found = by("fixation")(ball, recogniser).recognise(recogniser)
    assert found.unknown is None
    assert found.compared == 4
    assert found.novelty_rank == pytest.approx(4 / 5)
    sentence = (
        "4 known objects are too few to call an object unknown (29 are needed); this one lies farther out than all of "
        "them, so it may be of another class."
    )
    assert found.notes[0] == sentence
    assert sentence in repr(found)
    assert f"<p>{sentence}</p>" in found._repr_html_()


def test_the_sentence_on_few_objects_counts_those_that_are_less_novel():
    answer = ModelAnswer({"cup": 1.0}, ("cup",), 7 / 13, None, 0.9, 12)
    assert note_on_few_objects(answer) == (
        "12 known objects are too few to call an object unknown (29 are needed); this one lies farther out than 7 of "
        "them."
    )
    assert note_on_few_objects(replace(answer, unknown=False)) is None
    assert note_on_few_objects(ModelAnswer({"cup": 1.0})) is None


def test_a_model_of_many_objects_calls_a_far_object_unknown_and_states_no_set(ball, tmp_path):
    many = vh.read_recogniser(fit_on_nonsense(tmp_path, objects=(15, 15)))
    found = by("fixation")(ball, many).recognise(many)
    assert (found.unknown, found.name, found.compared) == (True, "unknown", 30)
    assert "one of:" not in repr(found) + found._repr_html_()
    assert not any("too few" in note for note in found.notes)


@pytest.mark.parametrize(
    ("degrees", "x", "z"), [(90, 3.0, -1.0), (180, -1.0, -3.0), (270, -3.0, 1.0)]
)
def test_touches_turn_about_the_vertical_from_z_towards_x(degrees, x, z):
    table = features_table(objects=(1,), viewpoints=1)
    here = {"x": 1.0, "y": 2.0, "z": 3.0, "normal_x": 1.0, "normal_y": 2.0, "normal_z": 3.0}
    for name, value in here.items():
        table = with_column(table, name, [value] * table.num_rows)
    turned = turn_touches(table, degrees)
    there = {"x": x, "z": z, "normal_x": x, "normal_z": z}
    for name in table.column_names:
        expected = there.get(name, table.column(name)[0].as_py())
        assert turned.column(name)[0].as_py() == expected
    assert turned.schema == table.schema


class Compass:
    """A model that names the side to which the object's first touch points."""

    uses_azimuth = True

    def recognise(self, features):
        sides = {"front": features["z"][0].as_py(), "left": features["x"][0].as_py()}
        name = max(sides, key=sides.get)
        return {name if sides[name] > 0.5 else "elsewhere": 1.0}


def test_a_note_names_the_classes_of_quarter_turns_if_another_class_is_named():
    table = features_table(objects=(1,), viewpoints=1)
    for name, value in (("x", 0.0), ("z", 1.0)):
        table = with_column(table, name, [value] * table.num_rows)
    turned = classes_when_turned(Compass(), table)
    assert turned == {90: "left", 180: "elsewhere", 270: "elsewhere"}
    assert note_on_front("front", turned) == (
        "Turned about the vertical the answer is left (by 90 degrees), elsewhere (by 180 or 270 degrees): the model takes "
        "the front to face +z; give --front / front= if it faces another way."
    )
    assert note_on_front("front", dict.fromkeys(turned, "front")) is None
    assert "is left (by 90 degrees): the" in note_on_front("elsewhere", turned)


def test_an_answer_has_the_classes_of_quarter_turns_unless_the_models_frame_has_no_azimuth(
    ball, recogniser
):
    made = by("fixation")(ball, recogniser)
    found = made.recognise(recogniser)
    for degrees, name in found.turned.items():
        answer = recogniser.model.recognise(turn_touches(made.features, degrees))
        assert name == next(iter(answer))
    assert list(found.turned) == [90, 180, 270]
    for frame in ("none", "centre", "vertical"):
        parameters = RecognitionParameters(frame=frame)
        model = fit_model(
            features_table(objects=(2, 2)), "order_free", "naive_bayes", parameters, 1
        )
        free = vh.Recogniser(model, recogniser.parameters)
        assert made.recognise(free).turned == {}


def test_a_model_that_learnt_from_several_strategies_names_all(tmp_path, ball):
    several = vh.read_recogniser(fit_on_nonsense(tmp_path, ["fixation", "random"]))
    assert "touched by fixation, random: class0" in repr(several)
    assert by("random")(ball, several).recognise(several).caution is None
    found = given(ball, several).recognise(several)
    assert found.caution.startswith(
        "The model learnt from touches by fixation and random and these"
    )


def test_a_model_learns_from_several_strategies_though_one_lacks_touches_from_a_view(tmp_path):
    whole = features_table(objects=(2, 2), viewpoints=3)
    random = features_table("random", objects=(2, 2), viewpoints=3)
    table = join_parts(FEATURES, [whole, random.slice(1)])
    write_table(FEATURES, table, tmp_path / "features.parquet")
    make_model(
        [tmp_path / "features.parquet"], tmp_path / "m.skops", "order_free", "naive_bayes",
        ("random", "fixation"), RecognitionParameters(), {}, 1,
    )  # fmt: skip
    assert load_model(tmp_path / "m.skops").strategies == ("random", "fixation")


def test_one_touch_is_enough_and_a_point_off_the_surface_is_refused(ball, recogniser):
    one = ball.touch(at=PLACES[:1], parameters=recogniser.parameters)
    assert one.recognise(recogniser).touches == 1
    with pytest.raises(ParameterError, match="8 object radii off the surface"):
        ball.touch(at=[[0, 0, 9]], parameters=recogniser.parameters)


def test_places_that_the_sensor_can_not_reach_are_not_recognised(recogniser):
    inner = trimesh.creation.box((0.6, 0.6, 0.6))
    shut = vh.load(trimesh.util.concatenate([inner, trimesh.creation.box((1, 1, 1))]))
    corner = shut.surface.vertices.max()
    made = shut.touch(at=[[0, 0, 0.6 * corner]], parameters=recogniser.parameters)
    with pytest.raises(RecognitionError, match="could reach none of the 1 locations"):
        made.recognise(recogniser)
    made, _ = made.touch_next([0, corner, 0])
    assert made.recognise(recogniser).touches == 2


def test_a_model_of_another_frame_is_refused_at_given_points(ball, recogniser):
    asked = recogniser.parameters.model_dump(exclude={"recognition"}, exclude_unset=True)
    made = ball.touch(at=PLACES, parameters={**asked, "recognition": {"frame": "none"}})
    with pytest.raises(RecognitionError, match="frame is none, and the model was fitted for full"):
        made.recognise(recogniser)


def test_a_policy_that_touches_nothing_leaves_nothing_to_recognise(ball, recogniser, monkeypatch):
    lazy = vh.Policy("lazy", "touches nothing", lambda *_: None)
    entries = {one.name: one for one in STRATEGIES} | {"lazy": lazy}
    monkeypatch.setattr(STRATEGIES, "_entries", entries)
    with pytest.raises(MeshError, match="policy lazy made no touch of unknown/object: it stopped"):
        ball.touch(1, "lazy", recogniser.parameters)
