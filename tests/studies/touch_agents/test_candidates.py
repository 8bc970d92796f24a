"""Candidates that were touched once are what the environment gives in the course of an episode."""

import numpy as np
import pytest

import visuohaptic as vh
from touch_agents import candidates as module
from visuohaptic.environment import TouchVectorEnv
from visuohaptic.environment.episodes import Episode
from visuohaptic.parameters import as_parameters

PARAMETERS = as_parameters({"viewpoints.count": 2, "rendering.resolution": 64})


@pytest.fixture(scope="module", params=["upright", "turned"])
def setting(request):
    return request.param


@pytest.fixture(scope="module")
def keys():
    return TouchVectorEnv(1, split="all").keys[:2]


@pytest.fixture(scope="module")
def collected(setting, keys):
    return module.collect(None, setting, PARAMETERS, keys)


@pytest.mark.slow
def test_touches_at_candidates_are_those_of_an_episode_in_any_order(collected, setting, keys):
    own = collected["seeing"]
    turns = "any" if setting == "turned" else "none"
    rows = TouchVectorEnv(
        1, None, "all", PARAMETERS, places=module.SPREAD, turns=turns, turn_draws=4, touches=3
    )
    for start, viewpoint in ((1, 1), (2, 0)):
        key, turn = own.keys[own.owners[start]], viewpoint * 2
        chosen = {"object": key, "viewpoint": viewpoint, "turn_draw": turn, "draw": 5}
        seen, _ = rows.reset(seed=3, options=chosen)
        indices = np.flatnonzero(seen["valid"][0, :-1])
        assert own.valid[start].sum() == len(indices)
        for place in (len(indices) - 1, 0, 7):
            touched, features = module.touch_all(rows, indices[[place]])
            assert touched.all()
            np.testing.assert_array_equal(features[0], own.touches[start, place])
            assert np.allclose(own.anchors[start, place], features[0, 16:19], atol=1e-6)


@pytest.mark.slow
def test_places_of_a_blind_agent_are_as_many_as_a_seeing_agent_has(collected, setting):
    seeing, blind = collected["seeing"], collected["blind"]
    np.testing.assert_array_equal(seeing.valid.sum(axis=1), blind.valid.sum(axis=1))
    assert seeing.keys == blind.keys
    np.testing.assert_array_equal(seeing.owners, [0, 0, 1, 1])
    points = blind.touches[:, :, 16:19][blind.valid]
    lengths = np.linalg.norm(points, axis=1, keepdims=True)
    np.testing.assert_allclose(blind.anchors[blind.valid], points / lengths, atol=1e-6)


@pytest.mark.slow
def test_a_blind_agent_is_told_directions_at_most_and_its_environment_shows_nothing(
    collected, setting, keys, monkeypatch
):
    blind = collected["blind"]
    told = blind.anchors if setting == "upright" else np.zeros((*blind.valid.shape, 0))
    np.testing.assert_array_equal(blind.known, told)
    shown = []
    observe = Episode.observe_sight

    def note(self):
        shown.append((self.settings.action, self.settings.sight, [*observe(self)]))
        return observe(self)

    monkeypatch.setattr(Episode, "observe_sight", note)
    module.collect(None, setting, PARAMETERS, keys[:1])
    assert {(sight, len(parts)) for action, sight, parts in shown if action == "point"} == {((), 0)}


@pytest.mark.slow
def test_what_is_seen_belongs_to_the_place(collected, setting, keys):
    own = collected["seeing"]
    known, points, valid = own.known, own.anchors, own.valid
    radii = np.linalg.norm(points, axis=-1)[valid]
    np.testing.assert_allclose(known[valid][:, 7], radii)
    outward = (points * own.touches[..., 19:22]).sum(axis=-1)[valid] / radii
    np.testing.assert_allclose(known[valid][:, 17], outward, atol=1e-6)
    turns = "any" if setting == "turned" else "none"
    rows = TouchVectorEnv(
        1, None, "all", PARAMETERS, places=module.SPREAD, turns=turns, turn_draws=4, touches=1
    )
    chosen = {"object": keys[1], "viewpoint": 1, "turn_draw": 2, "draw": 0}
    seen, _ = rows.reset(seed=0, options=chosen)
    fixated = np.flatnonzero(seen["valid"][0, : len(seen["fixations"][0])])
    position = known[3, : len(fixated), :2] * [1, -1]
    np.testing.assert_allclose(position, seen["fixations"][0, fixated], atol=0.02)
    np.testing.assert_allclose(known[3, : len(fixated), 13] * 21, fixated)


@pytest.mark.slow
@pytest.mark.parametrize("setting", ["upright"], indirect=True)
def test_features_are_those_of_the_workflow(collected, keys):
    own, start = collected["seeing"], 0
    points = own.anchors[start, :3]
    table = vh.example(keys[0].partition("/")[0]).touch(at=points).features.to_pandas()
    names = [name for name in module.FEATURES if not name.startswith("contact_")]
    expected = table[[*names]].to_numpy()
    columns = [module.FEATURES.index(name) for name in names]
    np.testing.assert_allclose(own.touches[start, :3][:, columns], expected, atol=1e-4)


@pytest.mark.slow
def test_saved_candidates_are_read_back(collected, tmp_path):
    module.save_candidates(collected, 2.5, tmp_path / "folder/some.npz")
    again, seconds = module.load_candidates(tmp_path / "folder/some.npz")
    assert seconds == 2.5
    for senses, own in collected.items():
        np.testing.assert_array_equal(again[senses].touches, own.touches)
        np.testing.assert_array_equal(again[senses].valid, own.valid)
        assert again[senses].keys == own.keys
        np.testing.assert_array_equal(again[senses].labels, own.labels)


def test_the_outline_and_a_ridge_are_found_in_a_depth_map():
    depth = np.full((16, 16), np.nan)
    depth[4:12, 4:12] = 2.0
    depth[4:12, 8] = 1.8
    inside, fold, uneven = module._relief(depth, ~np.isnan(depth))
    assert inside[3, 3] == 0
    assert inside[7, 7] == pytest.approx(4 * 2 / 16)
    assert fold[7, 8] < -0.1 < fold[7, 6]
    assert uneven[7, 8] > uneven[7, 5] > -1e-9
