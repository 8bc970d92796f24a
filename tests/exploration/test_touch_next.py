"""One more touch gives what it felt, and the tables of all touches."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

import visuohaptic as vh
from visuohaptic.active import sessions
from visuohaptic.active.registry import STRATEGIES
from visuohaptic.base.errors import ParameterError
from visuohaptic.exploration import touching_points
from visuohaptic.exploration.touching_points import SCHEMAS

PLACES = np.array([[1.0, 0, 0], [0, 1.0, 0], [0, 0, -1.0]])
NOISY = {"scene.preset": "worn_fsr"}


@pytest.fixture(scope="module")
def ball():
    return vh.load(trimesh.creation.icosphere(4))


def test_touches_one_by_one_are_those_at_all_points(ball):
    made = ball.touch(at=PLACES[:1], parameters=NOISY)
    for place in PLACES[1:]:
        made, felt = made.touch_next(place)
    together = ball.touch(at=PLACES, parameters=NOISY)
    for name in SCHEMAS:
        one, other = made.tables[name], together.tables[name]
        if name == "effects":
            one, other = one.drop_columns("seconds"), other.drop_columns("seconds")
        assert one.equals(other), name
    np.testing.assert_array_equal(felt.imprint, together.imprints[2])
    assert felt.acquired
    assert felt.features["contourlet_01"] == together.features["contourlet_01"].to_pylist()[2]
    assert felt.contact_state == together.touches["contact_state"].to_pylist()[2]
    assert made.seconds["touch"] > 0


def test_a_given_normal_is_the_sensors(ball):
    made = ball.touch(at=PLACES[:1], normals=PLACES[:1])
    _, felt = made.touch_next([0, 1, 0], normal=[0, 2, 2])
    np.testing.assert_allclose(felt.normal, [0, np.sqrt(0.5), np.sqrt(0.5)], atol=1e-12)


def test_a_place_that_the_sensor_can_not_reach_is_not_acquired():
    inner = trimesh.creation.box((0.6, 0.6, 0.6))
    outer = trimesh.creation.box((1, 1, 1))
    shut = vh.load(trimesh.util.concatenate([inner, outer]))
    corner = shut.surface.vertices.max()
    made = shut.touch(at=[[0, 0, corner]])
    made, inside = made.touch_next([0, 0, 0.6 * corner])
    made, outside = made.touch_next([0, corner, 0])
    assert (inside.acquired, outside.acquired) == (False, True)
    assert made.touches.num_rows == 3


class Broken:
    """An array-like whose conversion fails."""

    def __array__(self, *_, **__):
        raise RuntimeError("detach it")


@pytest.mark.parametrize(
    ("choices", "sentence"),
    [
        ({"point": [[1, 0, 0]]}, r"point has the shape \(1, 3\); \(3,\) is needed"),
        ({"point": 3}, r"point has the shape \(\)"),
        ({"point": [[1], [2, 3]]}, "point holds no numbers"),
        ({"point": [np.nan, 0, 0]}, "at has NaN"),
        ({"point": [9.9e5, 0, 0]}, r"9\.9e\+05 object radii off the surface"),
        ({"point": [1e6, 0, 0]}, r"at has NaN, .* numbers beyond 1e\+06"),
        ({"point": [1e20, 0, 0]}, r"numbers beyond 1e\+06"),
        ({"point": Broken()}, "point holds no numbers"),
        ({"point": [0, 0, 9]}, "8 object radii off the surface"),
        ({"point": [1, 0, 0], "normal": [1, 0]}, r"normal has the shape \(2,\)"),
    ],
)
def test_a_point_that_is_none_is_one_sentence(ball, choices, sentence):
    with pytest.raises(ParameterError, match=sentence):
        ball.touch(at=PLACES[:1]).touch_next(**choices)


def test_touches_by_a_strategy_are_not_gone_on_from(ball):
    seen = ball.touch(viewpoints=1, strategy="random", parameters={"rendering.resolution": 64})
    with pytest.raises(ParameterError, match="strategy random; touch_next needs touches by touch"):
        seen.touch_next([1, 0, 0])


def test_the_time_of_choosing_is_no_time_of_touching(ball, monkeypatch):
    now = [0.0]

    def ponder(view, touches):
        now[0] += 3.0
        return view.places.points[len(touches)]

    start = sessions.start_sessions
    monkeypatch.setattr(
        sessions,
        "start_sessions",
        lambda *given: [replace(session, clock=lambda: now[0]) for session in start(*given)],
    )
    monkeypatch.setattr(touching_points, "time", SimpleNamespace(perf_counter=lambda: now[0]))
    entries = {"ponder": vh.Policy("ponder", "ponder", ponder)}
    monkeypatch.setattr(STRATEGIES, "_entries", entries)
    made = ball.touch(viewpoints=2, strategy="ponder")
    assert made.touches.num_rows == 10
    assert (made.seconds["touch"], made.seconds["choose"]) == (0.0, 30.0)


def test_a_policy_is_named_as_any_strategy_and_its_choosing_is_timed_apart(ball):
    small = {"rendering.resolution": 64}
    made = ball.touch(viewpoints=2, strategy="seek_relief", parameters=small)
    assert made.touches.num_rows == made.fixations.num_rows == 10
    assert set(made.seconds) == {"prepare", "look", "touch", "choose", "describe"}
    assert set(made.tables) == set(SCHEMAS)
