"""Policies of the experiment run in the environment, and agents in the experiment, with equal touches."""

from dataclasses import replace

import numpy as np
import pytest

import visuohaptic as vh
from visuohaptic.active.policies import Policy
from visuohaptic.active.registry import STRATEGIES
from visuohaptic.base.errors import ParameterError, RegistryError
from visuohaptic.environment import PolicyAgent, TouchEnv, TouchVectorEnv, agent_policy
from visuohaptic.geometry.surface import as_stored
from visuohaptic.geometry.turning import draw_rotation, turn_surface

POLICIES = [one.name for one in STRATEGIES if isinstance(one, Policy)]
PARAMETERS = {
    "viewpoints.count": 2,
    "rendering.resolution": 64,
    "sensor.resolution": 16,
    # Noise differs between touches.
    "scene.preset": "worn_fsr",
}
NAMES = ("chair", "bottle")
SEED = 2018
FRAMES = ("vertical", "centre", "none")
KNOWN = {"full": {}, **{frame: {"frame": frame, "upright": "object"} for frame in FRAMES}}
"""Settings of an environment that makes the touches of the experiment, by frame."""


@pytest.fixture(scope="module")
def objects():
    return [vh.example(name) for name in NAMES]


@pytest.fixture
def registered(monkeypatch):
    """Register policies for one test."""

    def add(policy):
        entries = {one.name: one for one in STRATEGIES._entries.values()} | {policy.name: policy}
        monkeypatch.setattr(STRATEGIES, "_entries", entries)
        return policy.name

    return add


def touched(thing, name, viewpoint, parameters=PARAMETERS):
    """Return imprints and points of the experiment's touches from a viewpoint."""
    felt = thing.touch(strategy=name, parameters=parameters)
    rows = [
        index for index, row in enumerate(felt.touches.to_pylist()) if row["viewpoint"] == viewpoint
    ]
    points = np.stack([felt.touches.column(axis).to_numpy() for axis in "xyz"], axis=1)
    return felt.imprints[rows], points[rows]


def felt_in(episode):
    made = [one for one in episode.felt if one.imprint is not None]
    return np.stack([one.imprint for one in made]), np.stack([one.point for one in made])


def standing(thing, turns, turn_draw):
    """Return an object as it stands in an environment with a draw of its turn."""
    rotation = draw_rotation(turns, thing.key, SEED, turn_draw)
    return replace(thing, surface=turn_surface(as_stored(thing.surface), rotation))


TURNED = {"upright": {}, "turned": {"turns": "any"}}


@pytest.mark.slow
@pytest.mark.parametrize("turned", TURNED)
@pytest.mark.parametrize("frame", KNOWN)
@pytest.mark.parametrize("name", POLICIES)
def test_a_policy_makes_the_touches_of_the_experiment_bit_for_bit(objects, name, frame, turned):
    settings = {"sight": (), "touches": 5, "random_stream": name, **KNOWN[frame], **TURNED[turned]}
    environment = TouchVectorEnv(4, objects, "all", PARAMETERS, action="object_point", **settings)
    keys = [one.key for one in objects for _ in range(2)]
    options = {"object": keys, "viewpoint": [0, 1, 0, 1], "draw": 0, "turn_draw": 1}
    environment.reset(seed=0, options=options)
    agent, logits = PolicyAgent(environment, name), np.zeros((4, 2))
    for _ in range(5):
        environment.step({"action": np.stack(agent.choose()), "prediction": logits})
    for row, episode in enumerate(environment.episodes):
        images, points = felt_in(episode)
        thing = standing(objects[row // 2], environment.settings.turns, 1)
        expected = touched(thing, name, row % 2)
        assert np.array_equal(images, expected[0][: len(images)])
        assert np.array_equal(points, expected[1][: len(points)])
        assert len(images) >= 3


def by_imprint(remembered=None):
    """Return an agent that goes on in the direction that the last imprint tells, and remembers where it was."""
    before = [] if remembered is None else remembered

    def act(seen):
        before.append(float(seen["imprint"].mean()))
        valid = np.flatnonzero(seen["valid"][:-1])
        if len(before) == 3:
            # A place that was touched, or is out of reach: a try without a touch.
            return int(np.flatnonzero(seen["valid"] == 0)[0])
        # The pose depends on the frame, so the same touches need the same frame.
        told = round(1e3 * float(np.abs(seen["pose"]).sum() + np.abs(seen["places"]).sum()))
        step = round(1e3 * sum(before)) + seen["view"].shape[0] + int(seen["contact"]) + told
        return int(valid[step % len(valid)])

    return act


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sight", "frame", "turned"),
    [
        (("view", "saliency", "fixations", "places"), "full", "upright"),
        *((("places", "view"), frame, turned) for frame in KNOWN for turned in TURNED),
    ],
)
def test_an_agent_makes_the_same_touches_as_a_strategy_and_in_the_environment(
    objects, registered, sight, frame, turned
):
    settings = {"touches": 5, "sight": sight, "places": 20, **KNOWN[frame]}
    name = registered(agent_policy("by_imprint", "by imprint", by_imprint, PARAMETERS, **settings))
    settings |= {"random_stream": name, **TURNED[turned]}
    environment = TouchEnv(objects=objects, split="all", parameters=PARAMETERS, **settings)
    for thing in objects:
        options = {"object": thing.key, "viewpoint": 1, "draw": 0, "turn_draw": 2}
        seen, _ = environment.reset(options=options)
        agent, ended = by_imprint(), False
        for _ in range(5):
            action = {"action": agent(seen), "prediction": [0, 0]}
            seen, _, ended, _, _ = environment.step(action)
        assert not ended
        images, points = felt_in(environment.vector.episodes[0])
        expected = touched(standing(thing, environment.vector.settings.turns, 2), name, 1)
        assert np.array_equal(images, expected[0])
        assert np.array_equal(points, expected[1])
        assert 3 <= len(images) <= 5


@pytest.mark.slow
@pytest.mark.parametrize("frame", FRAMES)
def test_an_agent_that_names_points_of_its_frame_makes_the_same_touches(objects, registered, frame):
    seen_by = []

    def mirror():
        """Return an agent that aims at the first places that it sees, moved by what it feels."""
        count = iter(range(9))

        def act(seen):
            seen_by.append({name: values.copy() for name, values in seen.items()})
            moved = 0.01 * float(seen["imprint"].mean())
            return seen["places"][next(count), :3].astype(float) + moved

        return act

    settings = {"touches": 3, "sight": ("places",), "places": 9, "action": "point", **KNOWN[frame]}
    name = registered(agent_policy("mirror", "mirror", mirror, PARAMETERS, **settings))
    environment = TouchEnv(
        objects=objects, split="all", parameters=PARAMETERS, random_stream=name, **settings
    )
    thing = objects[0]
    seen, _ = environment.reset(options={"object": thing.key, "viewpoint": 0, "draw": 0})
    agent = mirror()
    for _ in range(3):
        seen = environment.step({"action": agent(seen), "prediction": [0, 0]})[0]
    images, points = felt_in(environment.vector.episodes[0])
    in_environment = seen_by[:]
    seen_by.clear()
    expected = touched(thing, name, 0)
    assert len(images) == 3
    assert np.array_equal(images, expected[0])
    assert np.array_equal(points, expected[1])
    # The experiment touches from both viewpoints in turn.
    for first, second in zip(in_environment, seen_by[:6:2], strict=True):
        assert all(np.array_equal(first[entry], second[entry]) for entry in first)


@pytest.mark.slow
def test_an_agent_that_points_makes_the_same_touches_and_stops_after_its_tries(objects, registered):
    def looker():
        aims = iter([[0.1, 0.2], [0.99, 0.99], [-0.1, 0.0], [0.0, -0.2], [0.05, 0.3]])
        return lambda seen: next(aims)

    settings = {"touches": 4, "sight": (), "action": "direction"}
    name = registered(agent_policy("looker", "looks", looker, PARAMETERS, **settings))
    environment = TouchEnv(
        objects=objects, split="all", parameters=PARAMETERS, random_stream=name, **settings
    )
    environment.reset(options={"object": objects[1].key, "viewpoint": 0, "draw": 0})
    agent = looker()
    for _ in range(4):
        environment.step({"action": agent(None), "prediction": [0, 0]})
    images, points = felt_in(environment.vector.episodes[0])
    expected = touched(objects[1], name, 0)
    assert np.array_equal(images, expected[0])
    assert np.array_equal(points, expected[1])
    # The second direction is beside the object.
    assert 1 <= len(images) <= 3


def test_an_agent_may_keep_its_observations(objects, registered):
    kept = []

    def keeper():
        def act(seen):
            kept.append((seen, {name: values.copy() for name, values in seen.items()}))
            return int(np.flatnonzero(seen["valid"])[0])

        return act

    settings = {"touches": 3, "sight": ("places",), "places": 20}
    name = registered(agent_policy("keeper", "keeps", keeper, PARAMETERS, **settings))
    touched(objects[0], name, 0)
    assert len(kept) == 6
    assert all(np.array_equal(seen[entry], copy[entry]) for seen, copy in kept for entry in copy)


def test_an_agent_that_ends_its_episode_ends_the_sequence(objects, registered):
    def one_touch():
        left = iter([0, 1])

        def act(seen):
            valid = np.flatnonzero(seen["valid"])
            return valid[0] if next(left) == 0 else valid[-1]

        return act

    settings = {"sight": ("places",), "places": 20}
    name = registered(agent_policy("one_touch", "one touch", one_touch, PARAMETERS, **settings))
    images, _ = touched(objects[0], name, 0)
    assert len(images) == 1


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        ({"action": "place"}, "action is 'place' in frame 'full'; policies choose points"),
        ({"action": "point", "frame": "none", "upright": "object"}, "action 'object_point' is"),
        ({"action": "object_point", "frame": "centre"}, "upright is 'frame' in frame 'centre'"),
        ({"action": "object_point", "noise": 0.01}, "noise is 0.01; objects of the experiment"),
    ],
)
def test_a_policy_needs_the_objects_own_frame_and_points(objects, settings, sentence):
    environment = TouchEnv(objects=objects, split="all", parameters=PARAMETERS, **settings)
    with pytest.raises(ParameterError, match=sentence):
        PolicyAgent(environment, "seek_relief")


def test_an_agent_of_another_frame_and_a_strategy_that_is_no_policy_are_refused(objects):
    with pytest.raises(ParameterError, match="upright is 'frame' in frame 'none'"):
        agent_policy("far", "far", by_imprint, PARAMETERS, frame="none")
    environment = TouchEnv(objects=objects, split="all", parameters=PARAMETERS, action="point")
    with pytest.raises(RegistryError, match="a policy is needed"):
        PolicyAgent(environment, "fixation")


def test_a_policy_starts_anew_in_the_next_episode_and_stops_where_it_likes(objects, registered):
    calls = []

    def two(view, tries):
        calls.append((view, len(tries)))
        return view.places.points[len(tries)] if len(tries) < 2 else None

    name = registered(Policy("two", "two touches", two))
    environment = TouchEnv(
        objects=objects, split="all", parameters=PARAMETERS, action="point", sight=(), touches=9
    )
    agent = PolicyAgent(environment, name)
    for seed in (0, 1):
        environment.reset(seed=seed)
        for _ in range(2):
            [point] = agent.choose()
            environment.step({"action": point, "prediction": [0, 0]})
        assert agent.choose() == [None]
        assert agent.choose() == [None]
    assert [count for _, count in calls] == [0, 1, 2, 0, 1, 2]
    assert len({view for view, _ in calls}) == 2
