"""One answer from any number of sequences."""

import numpy as np
import pytest
from recognition.synthetic import clusters
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis

from visuohaptic.recognition import pooling
from visuohaptic.recognition.parameters import BestParameters, RecognitionParameters
from visuohaptic.recognition.pooling import (
    TEMPERATURES,
    Ballots,
    best_temperature,
    fit_bag_classifier,
    fit_combination,
    softmax,
    spread_bags,
    spread_choices,
)
from visuohaptic.recognition.tuning import fit_best_classifiers

SIZES = (1, 2, 4, 8, 16)


def combined(probabilities, scores, labels, owners, sizes=(1, 4)):
    known, best = np.ones(scores.shape[1], bool), BestParameters(bags=sizes)
    return fit_combination(probabilities, scores, labels, owners, known, best)


def test_bags_of_every_size_hold_each_sequence_of_an_object_once_and_no_other_objects():
    owners = np.repeat([3, 7], [16, 5])
    spread = spread_bags(owners, SIZES)
    bags = np.split(spread.places, np.cumsum(spread.counts)[:-1])
    assert all(len(set(owners[bag])) == 1 for bag in bags)
    for size in SIZES:
        held = [bag for bag in bags if len(bag) == size and owners[bag[0]] == 3]
        assert sorted(np.concatenate(held)) == list(range(16))
    sizes = [len(bag) for bag in bags if owners[bag[0]] == 7]
    assert sizes == [1] * 5 + [2] * 3 + [4] * 2 + [5]


@pytest.mark.parametrize("total", range(1, 33))
def test_choices_are_even_distinct_each_place_is_in_as_many_and_the_first_hold_all(total):
    for count in range(1, total + 1):
        choices = spread_choices(total, count)
        assert len(np.unique(choices, axis=0)) == len(choices)
        assert len(set(np.bincount(choices.ravel(), minlength=total))) == 1
        gaps = np.diff(choices, axis=1, append=choices[:, :1] + total)
        assert set(gaps.ravel()) <= {total // count, -(-total // count)}
        assert len(set(choices[: -(-total // count)].ravel())) == total


@pytest.mark.parametrize("objects", [(6, 10), (3, 3, 3)])
def test_scores_of_a_bag_are_the_discriminants_own_on_its_mean(objects):
    rows, labels, owners = clusters(objects=objects, columns=3, separation=0.1)
    bags = fit_bag_classifier(rows, labels, owners, (8,))
    means = rows.reshape(-1, 8, rows.shape[1]).mean(axis=1)
    theirs = LinearDiscriminantAnalysis(solver="lsqr", shrinkage=0.1).fit(means, labels[::8])
    other = np.random.default_rng(3).normal(size=(6, rows.shape[1]))
    ours = bags.scores(other, len(objects)).mean(axis=0, keepdims=True)
    expected = theirs.predict_proba(other.mean(axis=0, keepdims=True))
    np.testing.assert_allclose(softmax(ours), expected, atol=1e-6)


def test_both_answers_count_by_their_deviations_and_weight(monkeypatch):
    generator = np.random.default_rng(0)
    labels = np.repeat(np.arange(3), 40)
    probabilities = softmax(generator.normal(size=(120, 3)) + np.eye(3)[labels])
    scores = 100 * generator.normal(size=(120, 3)) + 100 * np.eye(3)[labels]
    owners = np.arange(120) // 4

    def answers(factor, weight):
        monkeypatch.setattr(pooling, "BAG_WEIGHT", weight)
        found = combined(probabilities, factor * scores, labels, owners)
        return Ballots(probabilities, factor * scores, found).alone()

    np.testing.assert_allclose(answers(1, 1.0), answers(7, 1.0))
    np.testing.assert_array_equal(answers(1, 1e6).argmax(axis=1), scores.argmax(axis=1))


@pytest.mark.parametrize("classes", range(2, 31))
def test_an_answer_without_a_preference_leaves_the_other_as_it_is(classes):
    generator = np.random.default_rng(classes)
    labels, owners = np.arange(32 * classes) // 32, np.arange(32 * classes) // 16
    scores = generator.normal(size=(len(labels), classes)) + np.eye(classes)[labels]
    alike = np.full(scores.shape, 1 / classes)
    answers = Ballots(alike, scores, combined(alike, scores, labels, owners, SIZES)).alone()
    ratios = np.log(answers[:, 1:] / answers[:, :1])
    slopes = ratios / (scores[:, 1:] - scores[:, :1])
    np.testing.assert_allclose(slopes, slopes[0, 0], rtol=1e-6)


def test_without_bags_an_answer_is_the_mean_probability_and_votes_that_tie_have_equal_shares():
    probabilities = softmax(np.random.default_rng(0).normal(size=(4, 3)))
    members = np.array([[True, True, False, False], [True, True, True, True]])
    found = Ballots(probabilities).together(members)
    np.testing.assert_allclose(found, [probabilities[:2].mean(axis=0), probabilities.mean(axis=0)])
    votes = np.eye(3)[[0, 0, 0, 1, 1, 1, 2]]
    found = Ballots(votes).together(np.ones((1, 7), dtype=bool))[0]
    assert found[0] == found[1]


def test_a_class_that_training_lacked_has_no_probability():
    rows, labels, owners = clusters(objects=(3, 3))
    chosen = RecognitionParameters(best={"classifiers": ["support_vector_machine"]})
    training = (rows, labels * 2, owners, 3)
    _, fits = fit_best_classifiers(*training, chosen, np.random.default_rng(0))
    found = fits[0][1].ballots(rows).together(np.ones((1, len(rows)), dtype=bool))
    assert found[0, 1] < 1e-20
    assert found.sum() == pytest.approx(1)


def test_the_least_log_loss_of_all_temperatures_is_found():
    generator = np.random.default_rng(4)
    for _ in range(20):
        scores = generator.normal(size=(30, 4)) * generator.uniform(0.1, 20)
        labels = generator.integers(4, size=30)
        relative = (scores - scores.max(axis=1, keepdims=True)) / TEMPERATURES[:, None, None]
        losses = np.log(np.exp(relative).sum(axis=2)) - relative[:, np.arange(30), labels]
        loss, temperature = best_temperature(scores, labels)
        assert temperature == TEMPERATURES[losses.mean(axis=1).argmin()]
        assert loss == pytest.approx(losses.mean(axis=1).min())


@pytest.mark.parametrize("objects", [4, 40])
def test_no_answer_is_surer_than_as_many_objects_allow(objects):
    labels = np.repeat(np.arange(2), objects // 2 * 4)
    owners = np.repeat(np.arange(objects), 4)
    clear = np.eye(2)[labels]
    surest = Ballots(clear, clear, combined(clear, clear, labels, owners)).alone().max()
    expected = 1 - 1 / (objects + 2) / 2
    assert surest == pytest.approx(expected, abs=0.3 * (1 - expected))


# Half of the objects must have bags of a number of views; else numbers share a temperature.
@pytest.mark.parametrize(
    ("views", "sizes", "shared"),
    [
        ([16] * 8, SIZES, [1, 2, 4, 8, 16]),
        ([15] + [16] * 7, SIZES, [1, 2, 4, (8 * 16 + 15) / 17, 16]),
        ([12, 13, 14, 15], SIZES, [1, 2, 4, 8, 12.5, 14.5]),
        ([3, 16, 16, 16, 16], (16,), [(3 + 4 * 16) / 5]),
    ],
)
def test_numbers_of_views_that_few_objects_have_share_a_temperature(views, sizes, shared):
    owners = np.repeat(np.arange(len(views)), views)
    labels = owners % 2
    scores = np.random.default_rng(0).normal(size=(len(owners), 2)) + np.eye(2)[labels]
    assert combined(softmax(scores), scores, labels, owners, sizes).views.tolist() == shared
