"""Intervals that hold the truth as often as they say, and exact tests."""

import itertools

import numpy as np
import pytest

from visuohaptic.evaluation.intervals import (
    balanced_interval,
    compare_paired,
    expanded_tail,
    holm,
    object_interval,
    object_intervals,
    rate_interval,
    resample_objects,
)
from visuohaptic.recognition.parameters import IntervalParameters

PARAMETERS = IntervalParameters(bootstrap_samples=1000)


def drawing():
    return np.random.default_rng(0)


@pytest.mark.slow
@pytest.mark.parametrize(("objects", "held"), [(12, 0.94), (40, 0.95)])
def test_interval_holds_the_mean_of_normal_objects_nearly_as_often_as_it_says(objects, held):
    generator = drawing()
    trials = 1000
    intervals = [
        object_interval(generator.normal(size=objects), np.ones(objects), PARAMETERS, generator)
        for _ in range(trials)
    ]
    share = np.mean([interval.low <= 0 <= interval.high for interval in intervals])
    # A plain percentile interval holds it in .91 of trials with 12 objects; three standard
    # errors of the share are .022.
    assert abs(share - held) < 0.022


def test_expanded_tail_tends_to_the_plain_one():
    assert expanded_tail(10**6, 0.95) == pytest.approx(0.025, rel=1e-4)
    assert expanded_tail(3, 0.95) < expanded_tail(12, 0.95) < 0.025


def test_the_ends_for_few_objects_are_expanded_percentiles():
    # Student's quantile with 4 degrees of freedom is 2.7764, times sqrt(5 / 4) 3.1042.
    tail = 0.000954
    assert expanded_tail(5, 0.95) == pytest.approx(tail, abs=1e-6)
    values = np.array([0.0, 0.2, 0.5, 0.6, 1.0])
    means = resample_objects(5, 1000, drawing()) @ values / 5
    interval = object_interval(values, np.ones(5), PARAMETERS, drawing())
    expected = np.quantile(means, [tail, 1 - tail])
    assert (interval.low, interval.high) == pytest.approx(expected, abs=1e-3)
    assert interval.low < np.quantile(means, 0.025) - 0.05
    assert interval.high > np.quantile(means, 0.975) + 0.05


def test_the_balanced_interval_of_one_class_is_the_plain_interval():
    values = np.array([0.0, 0.2, 0.5, 0.6, 1.0])
    plain = object_interval(values, np.ones(5), PARAMETERS, drawing())
    balanced = balanced_interval(values, np.zeros(5, dtype=int), PARAMETERS, drawing())
    assert vars(balanced) == pytest.approx(vars(plain), rel=1e-12)


def test_figures_of_the_same_objects_have_the_intervals_that_each_has_alone():
    values = np.random.default_rng(3).normal(size=(12, 3))
    weights = np.linspace(1, 2, 12)
    together = object_intervals(values, weights, PARAMETERS, drawing())
    for column, found in zip(values.T, together, strict=True):
        alone = object_interval(column, weights, PARAMETERS, drawing())
        assert vars(found) == pytest.approx(vars(alone), rel=1e-12)


@pytest.mark.parametrize(
    ("values", "weights", "expected"),
    [
        ([0.5] * 5, [1.0] * 5, (0.5, 0.5, 0.5)),
        ([0.5], [1.0], (0.5, np.nan, np.nan)),
        ([0.0, 1.0], [3.0, 1.0], (0.25, 0, 1)),
    ],
)
def test_equal_objects_have_no_width_a_single_one_no_interval_and_weights_weigh(
    values, weights, expected
):
    found = object_interval(np.array(values), np.array(weights), PARAMETERS, drawing())
    assert (found.mean, found.low, found.high) == pytest.approx(expected, nan_ok=True)


@pytest.mark.parametrize(("share", "ends"), [(1.0, (0.7354, 1.0)), (0.0, (0.0, 0.2646))])
def test_where_all_objects_agree_the_open_end_is_the_exact_binomial_limit(share, ends):
    values = np.full(12, share)
    interval = rate_interval(values, np.ones(12), PARAMETERS, drawing())
    # Of twelve objects: 0.025 ** (1 / 12) = 0.7354, as any table of binomial limits has it.
    assert (interval.low, interval.high) == pytest.approx(ends, abs=1e-4)


def test_exact_limits_leave_the_draws_of_later_intervals_as_they_are():
    first, second = drawing(), drawing()
    rate_interval(np.ones(12), np.ones(12), PARAMETERS, first)
    object_interval(np.ones(12), np.ones(12), PARAMETERS, second)
    assert first.random() == second.random()


def test_no_difference_among_twelve_objects_is_no_proof_of_equality():
    same = np.linspace(0, 1, 12)
    comparison = compare_paired(same, same, np.ones(12), PARAMETERS, drawing())
    found = (comparison.difference.low, comparison.difference.mean, comparison.difference.high)
    assert found == pytest.approx((-0.2646, 0, 0.2646), abs=1e-4)
    assert comparison.p_value == 1


def test_balanced_mean_gives_every_class_the_same_say():
    values, classes = np.array([1.0, 1.0, 1.0, 0.25, 0.0]), np.array([0, 0, 0, 1, 2])
    interval = balanced_interval(values, classes, PARAMETERS, drawing())
    assert interval.mean == pytest.approx(1.25 / 3)
    assert interval.low <= interval.mean <= interval.high


def test_p_value_counts_every_sign_change():
    generator = np.random.default_rng(1)
    first, second = generator.normal(0.5, 1, size=(2, 8))
    first += 0.4
    differences = first - second
    means = [abs(np.dot(signs, differences)) for signs in itertools.product([-1, 1], repeat=8)]
    expected = np.mean([mean >= abs(differences.sum()) - 1e-9 for mean in means])
    comparison = compare_paired(first, second, np.ones(8), PARAMETERS, generator)
    assert comparison.exact
    assert comparison.p_value == pytest.approx(expected)
    assert comparison.difference.mean == pytest.approx(differences.mean())


def test_a_paired_difference_and_its_p_value_weigh_objects():
    first, second = np.array([0.9, 0.5, 0.7, 0.2]), np.array([0.1, 0.6, 0.4, 0.0])
    weights = np.array([1.0, 6.0, 1.0, 2.0])
    parts = np.array([0.8, -0.6, 0.3, 0.4])  # differences times weights
    sums = [abs(np.dot(signs, parts)) for signs in itertools.product([-1, 1], repeat=4)]
    comparison = compare_paired(first, second, weights, PARAMETERS, drawing())
    assert comparison.difference.mean == pytest.approx(0.9 / 10)
    assert comparison.p_value == np.mean([total >= 0.9 - 1e-9 for total in sums])
    expected = object_interval(first - second, weights, PARAMETERS, drawing())
    assert vars(comparison.difference) == pytest.approx(vars(expected))


def test_many_objects_are_sampled_and_the_observed_one_counts():
    generator = np.random.default_rng(2)
    first = generator.normal(size=60)
    parameters = IntervalParameters(permutations=500)
    comparison = compare_paired(first + 5, first, np.ones(60), parameters, generator)
    assert not comparison.exact
    assert comparison.p_value == 1 / 501


def test_p_values_of_the_sampled_test_are_uniform_where_nothing_differs():
    generator = np.random.default_rng(3)
    parameters = IntervalParameters(permutations=200, bootstrap_samples=100)
    p_values = [
        compare_paired(*generator.normal(size=(2, 20)), np.ones(20), parameters, generator).p_value
        for _ in range(400)
    ]
    # Three standard errors of a share of .05 over 400 trials are .033.
    assert abs(np.mean(np.array(p_values) <= 0.05) - 0.05) < 0.033


def test_holm_as_by_hand():
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.9, 0.8]) == pytest.approx([1.0, 1.0])
    assert holm([]) == []
