"""Agents learn from training objects only, where touches tell the class, and know nothing of untouched places."""

from dataclasses import replace

import numpy as np
import pytest

from touch_agents import learner as module
from touch_agents.candidates import FEATURES, Candidates
from touch_agents.learner import Agent, Eyes, Learning, know, touched, train
from visuohaptic.tables.phases import CONTOURLET_FEATURES, IMPRINT_FEATURES

PLACES, TELLING = 16, 4
OWNER = FEATURES.index("imprint_skewness")
LEARNING = Learning(histories=3, compared=6, trees=20, leaf_rows=20, rate=0.2)


def synthetic(objects=12, views=3, seed=0):
    """Return candidates of three classes; known[..., 0] tells the `TELLING` places whose touch tells the class.

    The digits of feature `OWNER` after the third are the index of the object, see `owners_of`.
    """
    generator = np.random.default_rng(seed)
    keys = tuple(sorted(f"class{index % 3}/{index:02d}" for index in range(objects)))
    owners = np.repeat(np.arange(objects), views)
    shape = (len(owners), PLACES)
    telling = generator.random(shape).argsort(axis=1) < TELLING
    touches = 0.3 * generator.normal(size=(*shape, len(FEATURES)))
    labels = np.array([int(key[5]) for key in keys])[owners]
    shown = np.eye(3)[labels][:, None] * telling[..., None]
    for name in (*CONTOURLET_FEATURES, *IMPRINT_FEATURES):
        column = FEATURES.index(name)
        touches[..., column] += 2.0 * shown[..., column % 3]
    touches[..., OWNER] = touches[..., OWNER].round(3) + 1e-6 * owners[:, None]
    known = np.stack([telling, generator.random(shape)], axis=-1).astype(float)
    anchors = generator.normal(size=(*shape, 3))
    valid = np.ones(shape, dtype=bool)
    valid[:, -1] = False
    return Candidates(touches, known, anchors, valid, keys, owners)


def owners_of(touches):
    """Return the objects of touches (..., f) of synthetic candidates."""
    marks = touches[..., OWNER]
    return {*np.rint(1e6 * (marks - marks.round(3))).astype(int).ravel().tolist()}


@pytest.fixture(scope="module")
def candidates():
    return synthetic()


@pytest.fixture(scope="module")
def agent(candidates):
    return train(candidates, candidates.keys[::2], "full", learns=True, seed=1, learning=LEARNING)


def test_the_classes_of_starts_are_those_of_their_objects(candidates):
    assert candidates.labels.tolist() == [int(key[5]) for key in candidates.keys for _ in range(3)]
    assert candidates.starts_of(candidates.keys[1:3]).tolist() == [3, 4, 5, 6, 7, 8]


@pytest.mark.slow
def test_a_trained_agent_first_touches_where_touches_tell_the_class(candidates, agent):
    starts = np.repeat(candidates.starts_of(candidates.keys[1::2]), 8)
    chosen = agent.touch(candidates, starts, np.random.default_rng(0))
    telling = candidates.known[starts[:, None], chosen, 0]
    at_random = Agent(agent.eyes).touch(candidates, starts, np.random.default_rng(0))
    assert telling[:, 0].mean() > 0.9
    assert candidates.known[starts[:, None], at_random, 0].mean() < 0.4


@pytest.mark.slow
def test_an_agent_chooses_the_same_places_in_whatever_order_they_are_listed(candidates, agent):
    starts = candidates.starts_of(candidates.keys[1::2])
    order = np.random.default_rng(1).permutation(PLACES)
    shuffled = replace(
        candidates,
        **{
            name: getattr(candidates, name)[:, order]
            for name in ("touches", "known", "anchors", "valid")
        },
    )
    state, places = know(agent.eyes, candidates, starts, np.zeros((len(starts), 0), int))
    rows = module._join(state, places)
    worth = agent.values[0].predict(rows.reshape(-1, rows.shape[-1])).reshape(len(starts), PLACES)
    for own, listed in ((candidates, worth), (shuffled, worth[:, order])):
        first = agent.touch(own, starts, np.random.default_rng(2))[:, 0]
        best = np.where(own.valid[starts], listed, -np.inf).max(axis=1)
        np.testing.assert_allclose(listed[np.arange(len(starts)), first], best)


@pytest.mark.slow
def test_every_place_is_valid_and_touched_once(candidates, agent):
    for one in (agent, Agent(agent.eyes)):
        chosen = one.touch(candidates, np.arange(36), np.random.default_rng(0), explored=0.5)
        assert chosen.shape == (36, module.TOUCHES)
        assert candidates.valid[np.arange(36)[:, None], chosen].all()
        assert all(len({*row}) == module.TOUCHES for row in chosen.tolist())


@pytest.mark.slow
@pytest.mark.parametrize("learns", [True, False])
def test_other_objects_have_no_influence_on_training(candidates, learns):
    training = candidates.keys[::2]
    others = candidates.starts_of(candidates.keys[1::2])
    changed = {}
    for name in ("touches", "known", "anchors"):
        changed[name] = getattr(candidates, name).copy()
        changed[name][others] += 5.0
    agents = [
        train(own, training, "full", learns=learns, seed=1, learning=LEARNING)
        for own in (candidates, replace(candidates, **changed))
    ]
    chosen = [one.touch(candidates, others, np.random.default_rng(0)) for one in agents]
    np.testing.assert_array_equal(*chosen)
    logs = [one.eyes.logs(touched(candidates, others, chosen[0])) for one in agents]
    np.testing.assert_array_equal(*logs)


@pytest.mark.slow
def test_gains_of_an_object_come_from_probabilities_that_other_objects_taught(
    candidates, monkeypatch
):
    fitted = {}
    fit = Eyes.fit

    def note(self, touches, labels):
        fitted[self] = owners_of(touches)
        return fit(self, touches, labels)

    monkeypatch.setattr(Eyes, "fit", note)
    starts = np.arange(36)
    chosen = Agent(Eyes("full", 3, 0)).touch(candidates, starts, np.random.default_rng(0))
    lessons = module._lessons(
        candidates, starts, chosen, "full", 0, LEARNING, np.random.default_rng(0)
    )
    assert len(lessons) == 3
    for lesson in lessons:
        held_out = {*lesson.held_out.tolist()}
        assert fitted[lesson.eyes] == {*range(12)} - held_out
    assert sorted(np.concatenate([lesson.held_out for lesson in lessons])) == [*range(12)]


@pytest.mark.slow
def test_the_agent_of_a_later_round_did_not_learn_from_the_objects_that_it_touches(
    candidates, monkeypatch
):
    taught = {}
    regressions = module._regressions

    def note(lessons, own):
        made = regressions(lessons, own)
        taught[id(made)] = made, {int(one) for lesson in lessons for one in lesson.held_out}
        return made

    touch, seen = Agent.touch, []

    def follow(self, candidates, starts, generator, explored=0.0):
        if self.values:
            seen.append((taught[id(self.values)][1], {*candidates.owners[starts].tolist()}))
        return touch(self, candidates, starts, generator, explored)

    monkeypatch.setattr(module, "_regressions", note)
    monkeypatch.setattr(Agent, "touch", follow)
    train(candidates, candidates.keys, "full", learns=True, seed=1, learning=LEARNING)
    assert len(seen) == 3
    assert all(learnt.isdisjoint(own) and own for learnt, own in seen)


@pytest.mark.slow
def test_nothing_is_known_of_the_class_and_of_touches_that_were_not_made(candidates, agent):
    starts = np.arange(36)
    chosen = np.tile([3, 0], (36, 1))
    changed = candidates.touches.copy()
    changed[:, [1, 2, *range(4, PLACES)]] = 99.0
    renamed = tuple(f"class{(int(key[5]) + 1) % 3}{key[6:]}" for key in candidates.keys)
    of_both = [
        know(agent.eyes, own, starts, chosen)
        for own in (candidates, replace(candidates, touches=changed, keys=renamed))
    ]
    for before, after in zip(*of_both, strict=True):
        np.testing.assert_array_equal(before, after)
    anchors = candidates.anchors
    to_last = np.linalg.norm(anchors - anchors[:, [0]], axis=-1)
    to_first = np.linalg.norm(anchors - anchors[:, [3]], axis=-1)
    relations = of_both[0][1][..., -3:]
    np.testing.assert_allclose(relations[..., 0], to_last)
    np.testing.assert_allclose(relations[..., 1], np.minimum(to_last, to_first))
    np.testing.assert_allclose(relations[..., 2], (to_last + to_first) / 2)


@pytest.mark.slow
def test_a_gain_is_the_rise_of_the_log_probability_of_the_true_class(candidates, agent):
    starts, chosen = np.array([4, 20]), np.array([[1], [2]])
    tried = np.array([[3, 5, 7], [0, 9, 4]])
    found = module.gains(agent.eyes, candidates, starts, chosen, tried)
    for row, start in enumerate(starts):
        label = candidates.labels[start]
        before = agent.eyes.logs(candidates.touches[[start], chosen[row]][:, None])[0, label]
        for column in range(3):
            places = [chosen[row, 0], tried[row, column]]
            after = agent.eyes.logs(candidates.touches[start, places][None])[0, label]
            least = module.LEAST_LOG_PROBABILITY
            assert found[row, column] == pytest.approx(max(after, least) - max(before, least))


def test_before_the_first_touch_all_classes_are_equally_likely():
    logs = Eyes("full", 4, 0).logs(np.zeros((2, 0, len(FEATURES))))
    np.testing.assert_allclose(np.exp(logs), 0.25)


def test_a_start_with_too_few_places_is_refused(candidates):
    few = candidates.valid.copy()
    few[4, 9:] = False
    with pytest.raises(ValueError, match="A start has 9 places; at least 10 are needed"):
        train(
            replace(candidates, valid=few),
            candidates.keys,
            "full",
            learns=True,
            seed=1,
            learning=LEARNING,
        )
