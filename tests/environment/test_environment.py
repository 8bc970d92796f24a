"""The environment passes Gymnasium's checks, touches as the sensor does, and refuses what is not allowed."""

import pickle

import gymnasium
import numpy as np
import pytest
import trimesh
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.utils.env_checker import check_env
from gymnasium.vector.utils import iterate

import visuohaptic as vh
from visuohaptic.base.errors import ParameterError
from visuohaptic.environment import TouchEnv, TouchVectorEnv
from visuohaptic.environment.registration import NAME, register
from visuohaptic.environment.vector import MISS_COST
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import as_stored
from visuohaptic.geometry.turning import draw_rotation, turn_surface
from visuohaptic.parameters import as_parameters
from visuohaptic.sensor.frames import column_axes
from visuohaptic.sensor.sensing import touch
from visuohaptic.tables.phases import CONTACT_STATES, SPARE

PARAMETERS = {
    "viewpoints.count": 3,
    "rendering.resolution": 48,
    "sensor.resolution": 8,
    "attention.fixations": 2,
}


def shape(key, mesh):
    return vh.load((mesh.vertices, mesh.faces), key=key, up="y")


@pytest.fixture(scope="module")
def objects():
    ring, box = trimesh.creation.torus, trimesh.creation.box
    return [
        *(shape(f"ring/{name}", ring(0.7, 0.1 + 0.1 * name)) for name in range(3)),
        *(shape(f"box/{name}", box((1, 1 + name, 2))) for name in range(3)),
    ]


@pytest.fixture
def make(objects):
    def of(rows=None, **given):
        fixed = {"objects": objects, "split": "all", "parameters": PARAMETERS, "places": 6}
        arguments = {**fixed, **given}
        return TouchEnv(**arguments) if rows is None else TouchVectorEnv(rows, **arguments)

    return of


def valid_action(observation, classes=2, which=0):
    choices = [np.flatnonzero(row[:-1])[which] for row in observation["valid"]]
    return {"action": np.array(choices), "prediction": np.zeros((len(choices), classes))}


def play(environment, steps, seed):
    """Return all that an environment tells when the first valid places are touched."""
    told = [environment.reset(seed=seed)]
    for _ in range(steps):
        told.append(environment.step(valid_action(told[-1][0])))
    return told


def same(first, second):
    if isinstance(first, dict):
        return first.keys() == second.keys() and all(same(first[key], second[key]) for key in first)
    if isinstance(first, tuple | list):
        return all(map(same, first, second))
    return np.array_equal(first, second)


@pytest.mark.slow
@pytest.mark.parametrize("action", ["place", "direction", "point"])
@pytest.mark.parametrize("frame", ["full", "none"])
def test_gymnasiums_checker_passes_and_every_observation_is_in_its_space(make, action, frame):
    environment = make(action=action, frame=frame, noise=0.02, turns="any")
    with pytest.warns(UserWarning, match="Box action space") as warnings:
        check_env(environment, skip_render_check=True)
    # Logits have no bounds, as in ap_gym; nothing else is remarked.
    assert all("Box action space" in str(one.message) for one in warnings)


def test_both_environments_are_registered_and_a_second_registration_changes_nothing(objects):
    kept = gymnasium.spec(NAME)
    register()
    assert gymnasium.spec(NAME) is kept
    fixed = {"objects": objects, "parameters": PARAMETERS, "sight": ()}
    assert isinstance(gymnasium.make(NAME, **fixed).unwrapped, TouchEnv)
    rows = gymnasium.make_vec(NAME, num_envs=2, **fixed)
    assert isinstance(rows.unwrapped, TouchVectorEnv)
    assert rows.reset(seed=0)[0] in rows.observation_space


@pytest.mark.slow
def test_rows_equal_single_environments_with_the_next_seeds_bit_for_bit_over_several_episodes(make):
    settings = {"touches": 2, "frame": "none", "turns": "any", "noise": 0.01}
    told = play(make(3, **settings), 9, seed=4)
    for row in range(3):
        environment = make(**settings)
        seen, _ = environment.reset(seed=4 + row)
        ended = False
        for step, (observations, *rest) in enumerate(told):
            if step and ended:
                # The step after the end starts the next episode.
                seen, ended = environment.reset()[0], False
                assert rest[0][row] == 0
            elif step:
                action = {
                    "action": np.flatnonzero(seen["valid"][:-1])[0],
                    "prediction": np.zeros(2),
                }
                seen, reward, ended, _, _ = environment.step(action)
                assert (reward, ended) == (rest[0][row], rest[1][row])
            mine = [*iterate(make(3, **settings).observation_space, observations)][row]
            assert same(seen, mine)


@pytest.mark.slow
def test_one_seed_gives_equal_environments_and_another_seed_gives_others(make):
    first, second, third = (play(make(4), 5, seed) for seed in (1, 1, 2))
    assert same(first, second)
    assert not same(first[0], third[0])


def test_a_touch_equals_the_sensors_imprint_at_the_place_that_was_seen(make, objects):
    environment = make(4)
    before, told = environment.reset(seed=0)
    action = valid_action(before, which=2)
    after = environment.step(action)[0]
    parameters = as_parameters(PARAMETERS)
    surfaces = {one.key: as_stored(one.surface) for one in objects}
    for row, choice in enumerate(action["action"]):
        caster = RayCaster(surfaces[told["object"][row]])
        [one] = environment.episodes[row].felt
        nearest, faces = caster.nearest(one.point[None])
        felt = touch(
            caster, nearest, one.normal[None], parameters.sensor, parameters.scene, None, faces
        )
        assert np.array_equal(after["imprint"][row], felt.images[0])
        assert after["size"][row] == np.float32(felt.size[0])
        assert CONTACT_STATES[after["contact"][row] - 1] == felt.contact_state[0]
        pose = np.concatenate([one.point, felt.normals[0], felt.tangents[0]])
        assert np.array_equal(after["pose"][row], pose.astype(np.float32))
        assert np.array_equal(before["places"][row, choice], pose[:6].astype(np.float32))


def test_the_first_places_are_the_fixations_that_are_seen_in_the_view(make):
    environment = make(3)
    seen, told = environment.reset(seed=5)
    count = 2 + SPARE
    cameras = place_cameras(as_parameters(PARAMETERS).viewpoints)
    for row, viewpoint in enumerate(told["viewpoint"]):
        fixations = seen["fixations"][row]
        shown = fixations.any(axis=1)
        points = seen["places"][row, :count, :3][shown].astype(float)
        pixels = cameras[viewpoint].project(points, 48)
        assert pixels == pytest.approx(24 + 24 * fixations[shown] * [1, -1], abs=0.01)
        rows, columns = (
            np.floor(24 - 24 * fixations[shown][:, 1]).astype(int),
            np.floor(24 + 24 * fixations[shown][:, 0]).astype(int),
        )
        saliency = seen["saliency"][row, :, :, 0]
        assert (saliency[rows, columns] > 0).any()
        # The background is of one grey.
        assert (seen["view"][row][rows, columns] != seen["view"][row][0, 0]).any(axis=1).all()


def test_a_direction_touches_what_is_seen_there(make):
    environment = make(4, action="direction", frame="full")
    seen, told = environment.reset(seed=5)
    aims = np.stack([row[row.any(axis=1)][1] for row in seen["fixations"]]).astype(float)
    after = environment.step({"action": aims, "prediction": np.zeros((4, 2))})
    assert after[4]["touched"].any()
    cameras = place_cameras(as_parameters(PARAMETERS).viewpoints)
    for row in np.flatnonzero(after[4]["touched"]):
        shown = cameras[told["viewpoint"][row]].project(after[0]["pose"][row, :3].astype(float), 48)
        assert shown == pytest.approx(24 + 24 * aims[row] * [1, -1], abs=0.01)


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_a_direction_beside_the_object_touches_nothing_and_costs_the_stated_reward(
    make, projection
):
    parameters = PARAMETERS | {"viewpoints.projection": projection}
    environment = make(action="direction", parameters=parameters, touch_cost=0.25)
    environment.reset(seed=0)
    seen, reward, ended, _, told = environment.step(
        {"action": [0.99, 0.99], "prediction": [0.0, 0.0]}
    )
    assert not told["touched"]
    assert not ended
    assert told["base_reward"] == -0.25 - MISS_COST
    # A blind guess loses 1.
    assert reward == pytest.approx(-0.25 - MISS_COST - 1)
    assert (seen["contact"], seen["size"], seen["imprint"].any()) == (0, 0, False)


def test_places_out_of_reach_and_touched_places_are_masked_and_touch_nothing(make):
    environment = make(touches=8)
    seen, _ = environment.reset(seed=0)
    index = int(np.flatnonzero(seen["valid"][:-1])[0])
    action = {"action": index, "prediction": np.zeros(2)}
    seen, _, _, _, told = environment.step(action)
    assert told["touched"]
    assert seen["valid"][index] == 0
    seen, _, _, _, told = environment.step(action)
    assert not told["touched"]
    assert not seen["imprint"].any()
    missing = int(np.flatnonzero(seen["valid"][:-1] == 0)[-1])
    assert not environment.step(action | {"action": missing})[4]["touched"]


def test_the_mask_says_which_places_the_sensor_reaches(make):
    """Touches of places in reach are never blocked; the corners inside of a hollow are out of reach."""
    environment = make(touches=100, objects=hollows(), places=256)
    seen, _ = environment.reset(seed=0, options={"object": "hollow/deep", "viewpoint": 0})
    count = 2 + SPARE
    exists = seen["places"].any(axis=1)
    assert (seen["valid"][:-1][exists] == 0).any()
    assert seen["valid"][:-1][count:].any()
    for index in np.flatnonzero(seen["valid"][:-1])[:20]:
        after, _, _, _, told = environment.step({"action": index, "prediction": np.zeros(2)})
        if told["touched"]:
            assert CONTACT_STATES[after["contact"] - 1] in {"full", "shrunk", "partial"}


def hollows():
    deep = trimesh.util.concatenate(
        [
            trimesh.creation.box(
                (0.05, 1.6, 1.6), trimesh.transformations.translation_matrix([x, 0, 0])
            )
            for x in (-0.05, 0.04, 0.13)
        ]
        + [
            trimesh.creation.box(
                (0.3, 0.05, 1.6), trimesh.transformations.translation_matrix([0, -0.8, 0])
            )
        ]
    )
    return [shape("hollow/deep", deep), shape("box/one", trimesh.creation.box())]


def test_an_object_without_enough_places_has_masked_places_and_no_crash(objects):
    thin = shape("needle/thin", trimesh.creation.cylinder(1e-4, 2.0, sections=3))
    environment = TouchVectorEnv(2, [thin, objects[0]], "all", PARAMETERS, touches=2, places=256)
    seen, _ = environment.reset(seed=0, options={"object": "needle/thin"})
    empty = ~seen["places"].any(axis=2)
    assert empty.any()
    assert not seen["valid"][:, :-1][empty].any()
    last = np.flatnonzero(empty[0])[-1]
    for _ in range(3):
        actions = {"action": np.array([last, last]), "prediction": np.zeros((2, 2))}
        seen, _, ended, _, told = environment.step(actions)
        assert not told["touched"].any()
    assert ended.all()


def test_an_episode_ends_after_its_touches_and_a_last_prediction_or_by_the_agent(make):
    environment = make(touches=3)
    for stops_at in (3, 0, 1):
        environment.reset(seed=1)
        seen, total, ended, steps = environment.reset(seed=1)[0], 0.0, False, 0
        while not ended:
            stops = steps == stops_at
            index = len(seen["valid"]) - 1 if stops else np.flatnonzero(seen["valid"])[0]
            seen, reward, ended, truncated, told = environment.step(
                {"action": index, "prediction": [0.0, 0.0]}
            )
            total, steps = total + reward, steps + 1
            assert not truncated
        assert steps == stops_at + 1
        assert seen["time_step"] == pytest.approx(2 * stops_at / 3 - 1)
        assert not told["touched"]
        # The prediction counts for the touches that are left: all ways lose four blind guesses.
        assert total == pytest.approx(-4.0)


def test_the_loss_is_the_cross_entropy_over_that_of_a_blind_guess(make):
    environment = make()
    environment.reset(seed=2)
    logits = np.array([0.5, 2.0])
    seen, _ = environment.reset(seed=2)
    action = {"action": np.flatnonzero(seen["valid"])[0], "prediction": logits}
    _, reward, _, _, told = environment.step(action)
    target = told["prediction"]["target"]
    expected = -np.log(np.exp(logits[target]) / np.exp(logits).sum()) / np.log(2)
    assert told["prediction"]["loss"] == pytest.approx(expected)
    assert reward == pytest.approx(-expected)
    huge = environment.loss_fn.numpy(np.array([[1e6, 0.0], [0.0, 1e6]]), np.array([0, 0]), (2,))
    assert huge == pytest.approx([0, 1e6 / np.log(2)])


@pytest.mark.parametrize("frame", ["vertical", "centre", "none"])
def test_a_frame_keeps_what_is_known_and_hides_the_rest(make, frame):
    environment = make(4, frame=frame)
    seen, told = environment.reset(seed=3)
    options = {"object": told["object"].tolist(), "viewpoint": told["viewpoint"].tolist()}
    known, _ = make(4).reset(seed=3, options=options)
    for row in range(4):
        points, full = seen["places"][row, :, :3], known["places"][row, :, :3]
        exists = known["places"][row].any(axis=1)
        points, full = points[exists].astype(float), full[exists].astype(float)
        gaps = [np.linalg.norm(one[:, None] - one, axis=2) for one in (points, full)]
        assert gaps[0] == pytest.approx(gaps[1], abs=1e-5)
        radii = [np.linalg.norm(one, axis=1) for one in (points, full)]
        assert np.allclose(*radii, atol=1e-5) == (frame != "none")
        assert np.allclose(points[:, 1], full[:, 1], atol=1e-5) == (frame == "vertical")
        assert not np.allclose(points[:, 0], full[:, 0], atol=1e-3)


def test_the_sensor_is_upright_in_the_agents_frame_so_that_imprints_do_not_tell_the_vertical(make):
    environment = make(6, frame="centre")
    seen, _ = environment.reset(seed=3)
    after = environment.step(valid_action(seen))[0]
    for row in range(6):
        normal, column = after["pose"][row, 3:6], after["pose"][row, 6:]
        assert column == pytest.approx(column_axes(normal[None].astype(float))[0], abs=1e-5)
        episode = environment.episodes[row]
        turned = as_stored(episode.body.read())
        turned = turn_surface(turned, episode.frame.rotation)
        caster = RayCaster(turned)
        [one] = episode.felt
        points, _ = caster.nearest(episode.frame.points(one.point[None]))
        parameters = as_parameters(PARAMETERS)
        felt = touch(
            caster, points, normal[None].astype(float), parameters.sensor, parameters.scene
        )
        # The same imprint as of an object that is turned like the frame.
        assert after["imprint"][row] == pytest.approx(felt.images[0], abs=1e-3)


@pytest.mark.parametrize("frame", ["full", "vertical", "centre", "none"])
def test_the_sensor_may_be_upright_in_the_objects_frame_and_then_no_axis_tells_the_turn(
    make, frame
):
    touches = {}
    for upright in ("object", "frame"):
        environment = make(4, frame=frame, upright=upright)
        seen, told = environment.reset(seed=3)
        after = environment.step(valid_action(seen))[0]
        touches[upright] = after
    own = make(4)
    options = {"object": told["object"].tolist(), "viewpoint": told["viewpoint"].tolist()}
    seen, _ = own.reset(seed=3, options=options)
    known = own.step(valid_action(seen))[0]
    assert np.array_equal(touches["object"]["imprint"], known["imprint"])
    assert np.array_equal(touches["frame"]["imprint"], known["imprint"]) == (frame == "full")
    assert touches["frame"]["pose"][:, 6:].any()
    assert touches["object"]["pose"][:, 6:].any() == (frame == "full")
    assert np.array_equal(touches["object"]["pose"][:, :6], touches["frame"]["pose"][:, :6])


def test_objects_are_turned_as_in_the_workflow(make, objects):
    environment = make(turns="any", turn_draws=3)
    environment.reset(seed=0, options={"object": "box/1", "turn_draw": 2})
    surface = environment.vector.episodes[0].body.subject.caster.surface
    stored = as_stored(next(one.surface for one in objects if one.key == "box/1"))
    turned = turn_surface(stored, draw_rotation("any", "box/1", 2018, 2))
    assert np.array_equal(surface.vertices, turned.vertices)


def test_touch_noise_moves_the_object_and_the_reported_pose_is_where_the_sensor_is(make):
    environment = make(touches=20, noise=0.05)
    seen, _ = environment.reset(seed=0)
    offsets = []
    for _ in range(12):
        index = int(np.flatnonzero(seen["valid"][:-1])[-1])
        place = seen["places"][index, :3]
        before = environment.vector.episodes[0].offset
        seen, _, _, _, told = environment.step({"action": index, "prediction": np.zeros(2)})
        if told["touched"]:
            episode = environment.vector.episodes[0]
            moved = episode.offset - before
            assert 0 < np.abs(moved).max() <= 0.05
            assert seen["pose"][:3] == pytest.approx(episode.last.point + before, abs=1e-6)
            # The sensor aims at the place as it was seen, and meets the surface that has moved.
            assert np.linalg.norm(seen["pose"][:3] - place) <= 0.1 + 1e-6
            offsets.append(before)
    assert len(offsets) > 3
    assert np.abs(offsets[-1]).max() > 0


@pytest.mark.parametrize(
    ("action", "sentence"),
    [
        ({"action": 99, "prediction": [0, 0]}, "action of row 0 is 99; an index from 0 to 24"),
        ({"action": -1, "prediction": [0, 0]}, "action of row 0 is -1"),
        ({"action": 0.5, "prediction": [0, 0]}, "1 whole numbers are needed"),
        ({"action": np.nan, "prediction": [0, 0]}, "1 whole numbers are needed"),
        ({"action": [0, 1], "prediction": [0, 0]}, "1 whole numbers are needed"),
        ({"action": 0, "prediction": [np.nan, 0]}, r"prediction of row 0 is \[nan, 0.0\]; finite"),
        ({"action": 0, "prediction": [np.inf, 0]}, "prediction of row 0"),
        ({"action": 0, "prediction": [0, 0, 0]}, r"of the shape \(1, 2\) are needed"),
        ({"action": 0, "prediction": "cup"}, r"of the shape \(1, 2\) are needed"),
        ({"action": 0}, "a dict with action and prediction is needed"),
        (3, "a dict with action and prediction is needed"),
    ],
)
def test_a_refused_action_changes_nothing_and_reset_follows(make, action, sentence):
    environment, other = make(), make()
    seen, _ = environment.reset(seed=0)
    other.reset(seed=0)
    with pytest.raises(ParameterError, match=sentence):
        environment.step(action)
    good = {"action": np.flatnonzero(seen["valid"])[0], "prediction": np.zeros(2)}
    assert same(environment.step(good), other.step(good))
    with pytest.raises(ParameterError):
        environment.step(action)
    assert same(environment.reset(seed=1), other.reset(seed=1))


@pytest.mark.parametrize(
    ("kind", "action", "sentence"),
    [
        ("direction", [np.nan, 0], "finite numbers from -1 to 1"),
        ("direction", [1.5, 0], r"action of row 0 is \[1.5, 0.0\]"),
        ("direction", 1, r"of the shape \(1, 2\)"),
        ("point", [0, 0, np.inf], r"action of row 0 is \[0.0, 0.0, inf\]"),
        ("point", [0, 0, 1e19], "finite numbers from -1e"),
    ],
)
def test_a_refused_direction_or_point_is_named(make, kind, action, sentence):
    environment = make(action=kind)
    environment.reset(seed=0)
    with pytest.raises(ParameterError, match=sentence):
        environment.step({"action": action, "prediction": [0, 0]})


def test_a_point_off_the_surface_touches_nothing(make):
    environment = make(action="point")
    environment.reset(seed=0)
    action = {"action": [1.2, 1.2, 1.2], "prediction": [0, 0]}
    assert not environment.step(action)[4]["touched"]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"touches": 0}, "touches is 0: a number of at least 1 is needed"),
        ({"frame": "center"}, "frame is 'center': did you mean centre"),
        ({"sight": ("views",)}, "sight.0 is 'views': did you mean view"),
        ({"turn": "any"}, "turn is no parameter; did you mean turns"),
        ({"split": "training"}, "split is 'training'; train, validation, test, all are allowed"),
        ({"objects": []}, "objects has 0 objects of 0 classes; at least two classes"),
        ({"render_mode": "human"}, "render_mode is 'human'"),
        ({"parameters": {"sensor.resolution": 0}}, "sensor.resolution is 0"),
    ],
)
def test_a_wrong_argument_is_named_with_what_is_allowed(make, arguments, sentence):
    with pytest.raises(ParameterError, match=sentence):
        make(**arguments)


@pytest.mark.parametrize("rows", [0, -1, 1.0, True])
def test_a_wrong_number_of_rows_is_refused(make, rows):
    with pytest.raises(ParameterError, match="num_envs is"):
        make(rows)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (
            {"object": "cup/mug"},
            "'object'. is 'cup/mug'; an object of the split is needed, such as box/0",
        ),
        ({"viewpoint": 3}, "'viewpoint'. is 3; a whole number from 0 to 2 is needed"),
        ({"viewpoint": [0, 1, 2]}, "has 3 values; one value, or 2, are needed"),
        ({"seed": 3}, "options has 'seed'; object, viewpoint, turn_draw, draw are allowed"),
    ],
)
def test_a_wrong_option_is_refused(make, options, sentence):
    with pytest.raises(ParameterError, match=sentence):
        make(2).reset(options=options)


def test_two_objects_with_one_key_are_refused(make, objects):
    with pytest.raises(ParameterError, match="7 objects with 6 different keys"):
        make(objects=[*objects, objects[0]])


def test_steps_before_a_reset_after_the_end_and_after_closing_are_refused(make):
    environment = make(touches=1)
    action = {"action": 0, "prediction": [0, 0]}
    with pytest.raises(ResetNeeded, match="before reset"):
        environment.step(action)
    environment.reset(seed=0)
    environment.step(action)
    assert environment.step(action)[2]
    with pytest.raises(ResetNeeded, match="has ended"):
        environment.step(action)
    environment.reset()
    environment.close()
    environment.close()
    for call in (environment.reset, lambda: environment.step(action)):
        with pytest.raises(ClosedEnvironmentError, match="closed"):
            call()


@pytest.mark.slow
def test_a_pickled_environment_is_a_new_one_with_the_same_arguments(make):
    for environment in (make(2, frame="none"), make(frame="none")):
        environment.reset(seed=0)
        copy = pickle.loads(pickle.dumps(environment))  # noqa: S301
        assert same(copy.reset(seed=7), environment.reset(seed=7))


@pytest.mark.slow
def test_spawned_workers_give_what_rows_give(objects):
    arguments = {"objects": objects, "split": "all", "parameters": PARAMETERS, "places": 6}
    rows = TouchVectorEnv(2, **arguments)
    workers = gymnasium.make_vec(
        NAME,
        num_envs=2,
        vectorization_mode="async",
        vector_kwargs={"context": "spawn"},
        **arguments,
    )
    try:
        seen, others = rows.reset(seed=0)[0], workers.reset(seed=0)[0]
        assert same(seen, others)
        action = valid_action(seen)
        assert same(rows.step(action)[:4], workers.step(action)[:4])
    finally:
        workers.close()


def test_observations_that_were_returned_stay_as_they_are(make):
    environment = make(3, touches=1)
    told = []
    seen, _ = environment.reset(seed=0)
    for step in range(5):
        told.append((seen, {name: values.copy() for name, values in seen.items()}))
        action = valid_action(seen)
        if step == 0:
            # The first row ends earlier, so that the rows start episodes in different steps.
            action["action"][0] = seen["valid"].shape[1] - 1
        seen = environment.step(action)[0]
    assert all(same(*pair) for pair in told)
    with pytest.raises(ValueError, match="read-only"):
        seen["view"][0] = 0
