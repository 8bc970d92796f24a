"""The environment of gymnasium touches where it is told to, and rewards as ap_gym does."""

import runpy
from pathlib import Path

import numpy as np
import pytest

EXAMPLE = Path(__file__).parents[2] / "examples" / "gymnasium_environment.py"


@pytest.fixture(scope="module")
def example():
    return runpy.run_path(str(EXAMPLE))


@pytest.fixture
def environment(example):
    return example["TouchEnvironment"](step_limit=3)


def action(move=(0, 0, 0), prediction=(0, 0, 0, 0)):
    return {
        "action": {"sensor_target_pos_rel": np.array(move, np.float32)},
        "prediction": np.array(prediction, np.float32),
    }


def test_it_passes_the_checks_of_gymnasium(environment):
    from gymnasium.utils.env_checker import check_env

    check_env(environment, skip_render_check=True)


def test_the_reward_is_minus_the_loss_and_the_length_of_the_movement(environment):
    environment.reset(seed=1)
    prediction = np.array([0.5, 2.0, -1.0, 0.0])
    _, reward, _, truncated, info = environment.step(action((0.6, 0, 0.8), prediction))
    target = info["prediction"]["target"]
    assert environment.objects[target].key == environment.thing.key
    loss = -np.log(np.exp(prediction[target]) / np.exp(prediction).sum())
    assert info["prediction"]["loss"] == pytest.approx(loss)
    assert info["base_reward"] == pytest.approx(-1e-3)
    assert reward == pytest.approx(-1e-3 - loss)
    assert not truncated


def test_it_touches_where_the_surface_is_nearest_to_the_place_that_is_asked_for(
    environment, example
):
    seen, _ = environment.reset(seed=2)
    assert seen["sensor_pos"] == pytest.approx(environment.position, abs=1e-6)
    move = np.array([0.0, 1.0, 0.0])
    # The sensor's own place: near an edge a place that is rounded may lie on another face.
    target = environment.position + environment.step_length * move
    after = environment.step(action(move))[0]
    imprint, position, rotation = example["touch_at"](environment.thing, target)
    assert after["sensor_pos"] == pytest.approx(position, abs=1e-6)
    assert after["sensor_img"][..., 0] == pytest.approx(2 * imprint - 1, abs=1e-6)
    second, third = np.split(after["sensor_rot"], 2)
    assert second == pytest.approx(rotation[:, 1], abs=1e-6)
    assert third == pytest.approx(rotation[:, 2], abs=1e-6)
    assert rotation.T @ rotation == pytest.approx(np.eye(3), abs=1e-6)
    assert np.linalg.det(rotation) == pytest.approx(1)
    vertices = environment.thing.surface.vertices
    assert np.linalg.norm(after["sensor_pos"] - target) <= (
        np.linalg.norm(vertices - target, axis=1).min() + 1e-6
    )


def test_an_episode_ends_with_the_last_step(environment):
    seen, _ = environment.reset(seed=3)
    ends, steps = [], [seen["time_step"]]
    for _ in range(3):
        seen, _, ended, _, _ = environment.step(action((1, 1, 1)))
        ends.append(ended)
        steps.append(seen["time_step"])
    assert ends == [False, False, True]
    assert steps == pytest.approx([-1, -1 / 3, 1 / 3, 1])


def test_a_movement_has_at_most_length_one(environment):
    places = []
    for move in (np.ones(3), np.ones(3) / np.sqrt(3), np.ones(3) / 4):
        environment.reset(seed=3)
        places.append(environment.step(action(move))[0]["sensor_pos"])
    assert places[0] == pytest.approx(places[1], abs=1e-6)
    assert np.linalg.norm(places[1] - places[2]) > 0.01


def test_every_class_comes_up_and_one_seed_gives_one_episode(environment):
    drawn = set()
    for seed in range(12):
        seen, _ = environment.reset(seed=seed)
        drawn.add(environment.target)
        again, _ = environment.reset(seed=seed)
        assert all(np.array_equal(seen[name], again[name]) for name in seen)
    assert drawn == {0, 1, 2, 3}
