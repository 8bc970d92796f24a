"""Policies choose each place by what was felt before, and a policy that misbehaves ends in one sentence."""

import logging
from dataclasses import replace

import numpy as np
import pyarrow.compute as pc
import pytest
import trimesh
from numerics.surfaces import of_trimesh

from visuohaptic.active import sessions
from visuohaptic.active.policies import Policy
from visuohaptic.active.registry import STRATEGIES
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.base.errors import PolicyError
from visuohaptic.fixations.object_views import ObjectViews
from visuohaptic.fixations.parameters import RenderingParameters, ViewpointParameters
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.scene.parameters import Scene, VisualModes
from visuohaptic.sensor import SensorParameters
from visuohaptic.tables.phases import EFFECTS, FIXATIONS, POINT_NAMES, SPARE, TOUCHES
from visuohaptic.tables.schema import check_table, join_parts, matrix
from visuohaptic.touches.acquiring import acquire_touches
from visuohaptic.touches.choosing import (
    Wanted,
    choose_locations,
    touched_locations,
    with_touch_numbers,
)
from visuohaptic.touches.touch_table import touch_part

SENSOR, SEED = SensorParameters(), 3
SCENE = Scene.model_validate({"preset": "worn_fsr"})
VIEWPOINTS = ViewpointParameters(count=3)
POLICIES = [one.name for one in STRATEGIES if isinstance(one, Policy)]


@pytest.fixture(scope="module")
def caster():
    ring = trimesh.creation.torus(0.7, 0.28)
    return RayCaster(of_trimesh(ring, np.full((len(ring.faces), 3), 128)))


@pytest.fixture
def with_policy(monkeypatch):
    """Register policies for a test, by name."""

    def add(name, next_location, **fields):
        entries = {one.name: one for one in STRATEGIES} | {
            name: Policy(name, name, next_location, **fields)
        }
        monkeypatch.setattr(STRATEGIES, "_entries", entries)
        return name

    return add


def acquire(caster, *names, viewpoints=(0, 1, 2), scene=SCENE, planned=None, **wanted):
    subject = Subject("ring/torus", lambda: caster, viewpoints)
    located = FIXATIONS.arrow.empty_table() if planned is None else planned
    wanted = Wanted(**{"touches": 4, **wanted})
    found = acquire_touches(subject, located, SENSOR, scene, SEED, wanted, VIEWPOINTS, names)
    for schema, table in (
        (TOUCHES, found.touches), (FIXATIONS, found.policy_fixations), (EFFECTS, found.effects),
    ):  # fmt: skip
        check_table(schema, table)
    return found


def planned_of(caster, *strategies):
    subject = Subject("ring/torus", lambda: caster, (0, 1, 2))
    attention, rendering = AttentionParameters(fixations=4), RenderingParameters(resolution=64)
    views = ObjectViews(subject, VIEWPOINTS, rendering, attention, strategies, VisualModes(), SEED)
    return views.fixations


def walk(view, touches):
    """Go through the places that the viewpoint sees."""
    return view.places.points[len(touches)]


@pytest.mark.parametrize("name", POLICIES)
def test_a_policy_touches_as_often_as_asked_for_and_no_place_twice(caster, name):
    found = acquire(caster, name)
    counts = found.touches.group_by("viewpoint").aggregate([("touch", "count")])
    assert counts.column("touch_count").to_pylist() == [4, 4, 4]
    for viewpoint in range(3):
        mine = found.policy_fixations.filter(
            pc.equal(found.policy_fixations["viewpoint"], viewpoint)
        )
        points = matrix(mine, POINT_NAMES)
        assert len(np.unique(points, axis=0)) == len(points)
        distances = np.linalg.norm(points - caster.nearest(points)[0], axis=1)
        assert (distances < 1e-6).all()


@pytest.mark.parametrize("name", POLICIES)
def test_a_policys_places_depend_on_object_viewpoint_and_seed_only_and_fewer_are_the_first(
    caster, name
):
    many = acquire(caster, name).touches
    alone = acquire(caster, name, viewpoints=(1,)).touches
    assert many.filter(pc.equal(many["viewpoint"], 1)).combine_chunks().equals(alone)
    few = acquire(caster, name, touches=2).touches
    assert few.equals(many.filter(pc.less(many["touch"], 2)).combine_chunks())


@pytest.mark.parametrize("name", POLICIES)
def test_a_policy_feels(caster, name, monkeypatch):
    """Other imprints lead to other places."""
    before = acquire(caster, name).policy_fixations
    touch = sessions.touch

    generator = np.random.default_rng(0)

    def feel_anything(*arguments):
        felt = touch(*arguments)
        shares = generator.random((len(felt.images), 1, 1))
        drawn = generator.random(felt.images.shape)
        return replace(felt, images=np.where(drawn < shares, drawn, 0).astype(np.float32))

    monkeypatch.setattr(sessions, "touch", feel_anything)
    after = acquire(caster, name).policy_fixations
    first = lambda table: table.filter(pc.equal(table["touch"], 0))  # noqa: E731
    assert first(after).equals(first(before))
    assert not after.equals(before)


def test_a_policy_is_given_what_was_felt(caster, with_policy):
    seen = []

    def remember(view, touches):
        seen.append(touches)
        assert not hasattr(view, "key")
        return walk(view, touches)

    found = acquire(caster, with_policy("remember", remember), viewpoints=(1,), unreachable="keep")
    assert [len(touches) for touches in seen] == [0, 1, 2, 3]
    last, row = seen[-1][-1], found.touches.to_pylist()[2]
    assert last.acquired
    np.testing.assert_array_equal(last.imprint.ravel(), np.float32(row["image"]))
    assert (last.sensor_size, last.contact_state) == (row["sensor_size"], row["contact_state"])
    np.testing.assert_array_equal(last.point, [row[name] for name in POINT_NAMES])
    np.testing.assert_array_equal(last.normal, [row[f"normal_{axis}"] for axis in "xyz"])


@pytest.mark.parametrize(
    ("part", "acquired"),
    [("point", True), ("normal", True), ("imprint", True), ("point", False), ("normal", False)],
)
def test_what_was_felt_can_not_be_written_to(caster, with_policy, monkeypatch, part, acquired):
    monkeypatch.setattr(
        sessions, "reachable", lambda _, points, *__: np.full(len(points), acquired)
    )
    walked = acquire(caster, with_policy("walk", walk))
    refused = []

    def forge(view, touches):
        for felt in touches[-1:]:
            array = getattr(felt, part)
            with pytest.raises(ValueError, match="read-only"):
                array *= 0
            refused.append(part)
            array.flags.writeable = True
            array *= 0
        return walk(view, touches)

    found = acquire(caster, with_policy("forge", forge, random_stream="walk"))
    assert refused
    for name in ("touches", "policy_fixations"):
        expected = getattr(walked, name)
        changed = getattr(found, name).drop_columns("strategy")
        assert changed.equals(expected.drop_columns("strategy")), name


def test_writing_to_an_imprint_is_the_policys_own_error(caster, with_policy):
    def forge(view, touches):
        for felt in touches:
            felt.imprint[:] = 1
        return walk(view, touches)

    with pytest.raises(PolicyError, match=r"try 1: it raised ValueError: .* read-only\.$"):
        acquire(caster, with_policy("forge", forge))


def test_touches_by_a_policy_are_those_at_its_places(caster, with_policy):
    """Column for column, with the sensor's noise, as if the places had been chosen before."""
    found = acquire(caster, with_policy("walk", walk))
    places, ranks = choose_locations(caster, found.policy_fixations, SENSOR, Wanted(4))
    part = touch_part(caster, places, SENSOR, SCENE, SEED, ranks)
    assert found.touches.equals(part.touches)
    counts = ["effect", "touches", "needed", "runs"]
    expected = [(one.effect, one.touches, one.needed, one.runs) for one in part.effects]
    assert list(zip(*(found.effects[name].to_pylist() for name in counts), strict=True)) == expected


def test_planned_touches_stay_as_they_are_beside_a_policy(caster, with_policy):
    planned = planned_of(caster, "fixation", "random")
    without = acquire(caster, planned=planned)
    both = acquire(caster, with_policy("walk", walk), planned=planned)
    is_own = pc.equal(both.touches["strategy"], "walk")
    assert both.touches.filter(pc.invert(is_own)).combine_chunks().equals(without.touches)
    assert both.touches.filter(is_own).num_rows == 12
    assert without.policy_fixations.num_rows == 0
    assert without.seconds == {}
    assert set(both.seconds) == {"choose"}
    merged = both.effects["touches"].to_pylist()
    assert merged == [one + 12 for one in without.effects["touches"].to_pylist()]


def test_one_table_holds_the_places_of_all_touches(caster, with_policy):
    planned = planned_of(caster, "fixation")
    found = acquire(caster, with_policy("walk", walk), planned=planned)
    places = touched_locations(
        join_parts(FIXATIONS, [planned, found.policy_fixations]), found.touches
    )
    assert places.select(TOUCHES.keys).equals(found.touches.select(TOUCHES.keys))
    np.testing.assert_array_equal(matrix(places, POINT_NAMES), matrix(found.touches, POINT_NAMES))


def unreachable_first(monkeypatch, count):
    """Let the first places of each viewpoint be out of reach."""
    tried = {}

    def reach(_, points, *__):
        found = []
        for point in points:
            number = tried.setdefault(len(points), [])
            found.append(len(number) >= count)
            number.append(point)
        return np.array(found)

    monkeypatch.setattr(sessions, "reachable", reach)


def test_a_place_out_of_reach_is_told_and_is_no_touch(caster, with_policy, monkeypatch):
    unreachable_first(monkeypatch, 2)
    told = []

    def remember(view, touches):
        told.append([one.acquired for one in touches])
        return walk(view, touches)

    name = with_policy("remember", remember)
    found = acquire(caster, name, viewpoints=(0,), touches=3)
    assert told[-1] == [False, False, True, True]
    assert found.touches["rank"].to_pylist() == [2, 3, 4]
    assert found.policy_fixations.num_rows == 5
    places = with_touch_numbers(found.policy_fixations.take([2, 3, 4]), np.arange(3))
    part = touch_part(caster, places, SENSOR, SCENE, SEED, np.array([2, 3, 4]))
    assert found.touches.equals(part.touches)
    unreachable_first(monkeypatch, SPARE + 1)
    found = acquire(caster, name, viewpoints=(0,), touches=3)
    assert found.policy_fixations.num_rows == SPARE + 1
    assert found.touches.num_rows == 0


@pytest.mark.parametrize("in_reach", [True, False])
def test_tries_are_sorted_by_their_keys(caster, with_policy, monkeypatch, in_reach):
    monkeypatch.setattr(
        sessions, "reachable", lambda _, points, *__: np.full(len(points), in_reach)
    )
    found = acquire(caster, with_policy("walk", walk))
    assert (found.touches.num_rows > 0) == in_reach
    tries = found.policy_fixations
    keys = list(zip(*(tries[key].to_pylist() for key in FIXATIONS.keys), strict=True))
    assert keys == sorted(keys)


def test_a_place_out_of_reach_is_touched_where_such_are_kept(caster, with_policy, monkeypatch):
    unreachable_first(monkeypatch, 2)
    told = []

    def remember(view, touches):
        told.append([(one.acquired, one.imprint is None) for one in touches])
        return walk(view, touches)

    name = with_policy("remember", remember, unreachable="keep")
    found = acquire(caster, name, viewpoints=(0,), touches=3)
    assert told[-1] == [(False, False), (False, False)]
    assert found.touches["rank"].to_pylist() == [0, 1, 2]
    assert set(found.policy_fixations["unreachable"].to_pylist()) == {"keep"}


def test_a_place_out_of_reach_that_is_skipped_counts_as_a_try(caster, with_policy, monkeypatch):
    unreachable_first(monkeypatch, 2)
    name = with_policy("walk", walk)
    found = acquire(caster, name, viewpoints=(0,), touches=3, unreachable="skip")
    assert found.policy_fixations.num_rows == 3
    assert found.touches["rank"].to_pylist() == [2]
    unreachable_first(monkeypatch, 2)
    own = with_policy("own", walk, unreachable="skip")
    found = acquire(caster, own, viewpoints=(0,), touches=3)
    assert found.touches["rank"].to_pylist() == [2]


def test_a_policy_may_stop_and_that_is_logged(caster, with_policy, caplog):
    name = with_policy(
        "brief", lambda view, touches: None if len(touches) == 2 else walk(view, touches)
    )
    with caplog.at_level(logging.WARNING):
        found = acquire(caster, name)
    assert found.touches.num_rows == 6
    assert "policy brief stopped before touch 4 of ring/torus, viewpoints 0, 1, 2" in caplog.text
    again = acquire(caster, name, when_exhausted="begin_again")
    assert again.touches["rank"].to_pylist() == [0, 1, 0, 1] * 3
    assert again.policy_fixations.equals(found.policy_fixations)
    lazy = with_policy("lazy", lambda *_: None)
    assert acquire(caster, lazy, when_exhausted="begin_again").touches.num_rows == 0


def test_a_policy_that_finds_no_place_in_reach_is_logged(caster, with_policy, caplog, monkeypatch):
    unreachable_first(monkeypatch, SPARE + 1)
    with caplog.at_level(logging.WARNING):
        acquire(caster, with_policy("walk", walk), viewpoints=(2,))
    sentence = (
        "policy walk ended before touch 4 of ring/torus, viewpoints 2: 17 places were out of reach."
    )
    assert [record.getMessage() for record in caplog.records] == [sentence]


@pytest.mark.parametrize(("seconds", "is_slow"), [(2.0, True), (0.5, False)])
def test_a_policy_slower_than_a_second_per_choice_is_logged(
    caster, with_policy, caplog, monkeypatch, seconds, is_slow
):
    now = [0.0]

    def ponder(view, touches):
        now[0] += seconds
        return walk(view, touches)

    start = sessions.start_sessions
    monkeypatch.setattr(
        sessions,
        "start_sessions",
        lambda *given: [replace(session, clock=lambda: now[0]) for session in start(*given)],
    )
    with caplog.at_level(logging.WARNING):
        found = acquire(caster, with_policy("ponder", ponder))
    sentence = "policy ponder took 24.0 s for 12 choices on ring/torus."
    assert [record.getMessage() for record in caplog.records] == [sentence] * is_slow
    assert found.seconds["choose"] == 12 * seconds


@pytest.mark.parametrize("stops", [False, True])
def test_a_choice_slower_than_the_policys_bound_is_one_sentence(caster, stops):
    def next_location(*_):
        now[0] += seconds
        return None if stops else np.array([1.0, 0, 0])

    now = [100.0]
    policy = Policy("slow", "slow", next_location, longest_seconds=30.0)
    (view,) = [
        session.view
        for session in sessions.start_sessions(
            Subject("ring/torus", lambda: caster, (2,)), [policy], VIEWPOINTS, SEED, "replace"
        )
    ]
    session = sessions.PolicySession("ring/torus", 2, policy, view, clock=lambda: now[0])
    seconds = 30.0
    session.choose()
    session.choose()
    seconds = 30.25
    sentence = (
        r"^policy slow, ring/torus, viewpoint 2, try 0: it took 30\.2 s to choose; at most 30 s are allowed "
        r"\(Policy\.longest_seconds\)\.$"
    )
    with pytest.raises(PolicyError, match=sentence):
        session.choose()
    assert session.seconds == 90.25


def test_a_run_ends_where_a_policy_is_slower_than_its_bound(caster, with_policy):
    """No call takes less than a billionth of a second."""
    name = with_policy("walk", walk, longest_seconds=1e-9)
    with pytest.raises(PolicyError, match=r"viewpoint 0, try 0: it took .* s to choose; at most"):
        acquire(caster, name)
    assert acquire(caster, with_policy("walk", walk)).touches.num_rows == 12


def test_a_slow_policy_that_raises_is_named_by_its_error(caster):
    now = [0.0]

    def next_location(*_):
        now[0] += 1000.0
        raise ValueError("no place left.")

    policy = Policy("slow", "slow", next_location)
    session = sessions.PolicySession("ring/torus", 0, policy, None, clock=lambda: now[0])
    with pytest.raises(PolicyError, match=r"it raised ValueError: no place left\.$"):
        session.choose()


class Broken:
    """An array-like whose conversion fails, as that of a tensor with gradients does."""

    def __array__(self, *_, **__):
        raise RuntimeError("detach it")


def fail(*_):
    raise ValueError("no\nplace left.")


def fail_silently(*_):
    raise ValueError


@pytest.mark.parametrize(
    ("next_location", "sentence"),
    [
        (
            lambda *_: [0.0, 0.0, 3.0],
            r"it chose \(0, 0, 3\), .* object radii off the surface; at most 0.1 is",
        ),
        (
            lambda view, _: view.places.points[0],
            r"try 1: it chose .*, the location of try 0; a new location, or None to stop, is needed\.$",
        ),
        (
            lambda *_: [np.nan, 0, 0],
            r"it chose \(nan, 0, 0\); finite numbers below 1e\+06 object radii are needed\.$",
        ),
        (lambda *_: [np.inf, 0, 0], "finite numbers below 1e"),
        (
            lambda *_: [0, -9.9e5, 0],
            r"it chose \(0, -9\.9e\+05, 0\), 9\.9e\+05 object radii off the",
        ),
        (lambda *_: [0, -1e6, 0], r"it chose \(0, -1e\+06, 0\); finite numbers below"),
        (lambda *_: [1e20, 0, 0], r"it chose \(1e\+20, 0, 0\); finite numbers below"),
        (lambda *_: [10**400, 0, 0], "it chose an object of type list; three numbers that float64"),
        (lambda *_: np.array([1j, 0, 0]), "it chose an object of type ndarray; three numbers"),
        (lambda *_: ["1", "0", "0"], "it chose an object of type list; three numbers"),
        (
            lambda view, _: np.ma.array(view.places.points[0], mask=[True, False, False]),
            "it chose a point with masked values",
        ),
        (lambda *_: Broken(), "it chose an object of type Broken; three numbers"),
        (
            lambda view, _: view.places.points,
            r"it chose an array of shape \(\d+, 3\); \(3,\) is needed",
        ),
        (lambda *_: 4, r"it chose an array of shape \(\); \(3,\) is needed"),
        (
            lambda *_: "there",
            "it chose an object of type str; three numbers that float64 holds, or None to stop, are",
        ),
        (lambda *_: [[0], [1, 2]], "it chose an object of type list; three numbers"),
        (fail, r"it raised ValueError: no place left\.$"),
        (fail_silently, r"it raised ValueError\.$"),
    ],
    ids=[
        *("off", "same", "nan", "infinite", "far", "farther", "beyond_float32", "beyond_float64"),
        *(
            "complex",
            "digits",
            "masked",
            "broken",
            "many",
            "number",
            "text",
            "ragged",
            "raises",
            "silent",
        ),
    ],
)
def test_a_policy_that_misbehaves_is_one_sentence(caster, with_policy, next_location, sentence):
    with pytest.raises(PolicyError, match=sentence) as caught:
        acquire(caster, with_policy("rogue", next_location))
    assert str(caught.value).startswith("policy rogue, ring/torus, viewpoint 0, try ")


def test_another_draw_of_a_policy_chooses_other_places(caster):
    first, second = (
        acquire(caster, name).policy_fixations for name in ("seek_relief", "seek_relief#1")
    )
    assert not np.array_equal(matrix(first, POINT_NAMES), matrix(second, POINT_NAMES))
