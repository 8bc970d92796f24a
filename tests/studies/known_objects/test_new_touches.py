"""Protocol `new_touches`: known objects in turns that training did not see."""

from functools import partial

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pytest
from recognition.synthetic import with_column
from studies.known_objects.made_up import PLANNED, turned_touches, with_touches
from studies.surfaces import RUN, small_surfaces

from known_objects.new_touches import Turned, answer_new_touches, check_new_points
from known_objects.study import MOST_TOUCHES, TURNS
from visuohaptic.base.errors import RecognitionError
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.turning import draw_rotation, turn_surface
from visuohaptic.pipeline import run
from visuohaptic.studies.conditions import with_changes


def test_each_view_is_answered_after_each_number_of_touches():
    answers = answer_new_touches(turned_touches(objects=2, turns=3, viewpoints=2), "fixation", 0)
    assert answers.num_rows == 2 * 3 * 2 * MOST_TOUCHES
    keys = answers.group_by(["class", "object", "turn", "viewpoint", "touches"]).aggregate([])
    assert keys.num_rows == answers.num_rows
    own = pc.binary_join_element_wise(answers["class"], answers["object"], "/")
    assert pc.equal(own, answers["answer"]).equals(answers["correct"])


@pytest.mark.slow
@pytest.mark.parametrize(("separation", "least", "most"), [(2.0, 0.95, 1.0), (0.0, 0.0, 0.75)])
def test_objects_that_feel_apart_are_told_apart_and_others_are_not(separation, least, most):
    turned = turned_touches(objects=3, turns=4, separation=separation)
    # The made-up classes differ by an offset of each object, too.
    if separation == 0:
        shuffled = np.random.default_rng(0)
        turned = with_touches(turned, lambda table: _objects_of_views(table, shuffled))
    answers = answer_new_touches(turned, "fixation", 0)
    last = answers.filter(pc.equal(answers["touches"], MOST_TOUCHES))
    assert least <= pc.mean(last["correct"].cast(pa.float64())).as_py() <= most


def _objects_of_views(table, generator):
    """Assign the sequences of each viewpoint to other objects."""
    classes = np.array(table["class"].to_pylist(), dtype=object)
    viewpoint = table["viewpoint"].to_numpy()
    names = np.unique(classes)
    dealt = classes.copy()
    for view in np.unique(viewpoint):
        for name, other in zip(names, generator.permutation(names), strict=True):
            dealt[(viewpoint == view) & (classes == name)] = other
    return with_column(table, "class", pa.array(dealt.tolist()))


def test_views_with_too_few_touches_are_left_out():
    turned = turned_touches(objects=2, turns=3, viewpoints=3)
    short = pc.and_(
        pc.equal(turned[1].features["viewpoint"], 2),
        pc.equal(turned[1].features["touch"], MOST_TOUCHES - 1),
    )
    turned[1] = Turned(turned[1].features.filter(pc.invert(short)), turned[1].parameters)
    answers = answer_new_touches(turned, "fixation", 0)
    assert answers.num_rows == (2 * 3 * 3 - 2) * MOST_TOUCHES


def test_one_object_is_refused():
    with pytest.raises(
        RecognitionError,
        match=r"There is one object .class0/object0.; new_touches needs at least two",
    ):
        answer_new_touches(turned_touches(objects=1), "fixation", 0)


@pytest.mark.parametrize(("turns", "said"), [(1, "1 turn;"), (2, "2 turns;")])
def test_too_few_turns_are_refused(turns, said):
    with pytest.raises(
        RecognitionError, match=f"class0/object0 has touches by fixation in {said}.*at least 3"
    ):
        answer_new_touches(turned_touches(turns=turns), "fixation", 0)


def test_no_touch_by_the_strategy_is_refused():
    with pytest.raises(RecognitionError, match="No view of any object has 20 touches by random"):
        answer_new_touches(turned_touches(), "random", 0)


def test_all_turns_differ_in_pose_and_seed():
    poses = [
        draw_rotation("any", "a/b", one.parameters.seed, one.parameters.meshes.turn_draw)
        for one in PLANNED
    ]
    assert len(poses) == TURNS
    assert len({pose.tobytes() for pose in poses}) == TURNS
    assert len({one.parameters.seed for one in PLANNED}) == TURNS
    assert len({one.key for one in PLANNED}) == TURNS


def touched_at_random(key, surface, parameters):
    """Touch an object at random, turned as the parameters say."""
    meshes = parameters.meshes
    rotation = draw_rotation(meshes.turns, key, parameters.seed, meshes.turn_draw)
    subject = Subject(key, partial(RayCaster, turn_surface(surface, rotation)), range(4))
    return Turned(run(subject, parameters)["features"], parameters)


@pytest.mark.slow
def test_random_places_are_new_in_each_turn_by_the_studys_seeds_and_not_by_one_seed():
    key, surface = next(iter(small_surfaces().items()))
    few = {"probing.strategies": ("random",), "recognition.touches": 2}
    first, second = (with_changes(RUN, {**one.condition.changes, **few}) for one in PLANNED[:2])
    own = [touched_at_random(key, surface, one) for one in (first, second)]
    check_new_points(key, "random", own)
    one_seed = second.model_copy(update={"seed": first.seed})
    leaking = [own[0], touched_at_random(key, surface, one_seed)]
    with pytest.raises(RecognitionError, match="at the same point in turns 0 and 1"):
        check_new_points(key, "random", leaking)
