"""One rule for intervals: it holds the truth as often as it says, and no end rises where an object gets worse."""

import itertools
import math

import numpy as np
import pytest
from scipy.stats import beta, binom

from visuohaptic.evaluation.intervals import (
    DIFFERENCE,
    EXTRA,
    SHARE,
    UNBOUNDED,
    balanced_interval,
    compare_paired,
    holm,
    object_interval,
)
from visuohaptic.recognition.parameters import IntervalParameters

PARAMETERS = IntervalParameters()
EQUAL = np.ones(12)
UNEQUAL = np.linspace(1, 4, 12)
LEAST_COVERAGE = 0.93
MISSED = beta.ppf(0.025, 12, EXTRA)
"""What twelve objects that agree leave of their value."""


def ends(values, weights=EQUAL, bounds=SHARE, parameters=PARAMETERS):
    found = object_interval(np.array(values, dtype=float), weights, parameters, bounds)
    return np.array([found.low, found.high])


def some_right(right, objects):
    return np.repeat([1.0, 0.0], [right, objects - right])


def drawn_low_end(values, weights, extra, draws=400_000):
    """Draw what the rule says: the 2.5 % quantile of the mean with random weights, and its standard error."""
    generator = np.random.default_rng(5)
    own = weights * generator.standard_gamma(1, size=(draws, len(values)))
    further = np.sum(weights**2) / weights.sum() * generator.standard_gamma(0.75, size=draws)
    means = (own @ values + further * extra) / (own.sum(axis=1) + further)
    parts = np.quantile(means.reshape(20, -1), 0.025, axis=1)
    return parts.mean(), parts.std(ddof=1) / math.sqrt(20)


@pytest.mark.parametrize("right", range(13))
def test_ends_of_all_or_nothing_objects_are_quantiles_of_beta_distributions(right):
    low = beta.ppf(0.025, right, 12 - right + 0.75) if right else 0
    high = beta.ppf(0.975, right + 0.75, 12 - right) if right < 12 else 1
    assert ends(some_right(right, 12)) == pytest.approx([low, high], abs=1e-9)


@pytest.mark.parametrize("objects", [3, 12, 20, 30, pytest.param(142, marks=pytest.mark.slow)])
def test_all_or_nothing_objects_are_covered(objects):
    found = np.array([ends(some_right(k, objects), np.ones(objects)) for k in range(objects + 1)])
    rates = np.arange(0.5, 0.9901, 0.005)[:, None]
    chances = binom.pmf(np.arange(objects + 1), objects, rates)
    held = (found[:, 0] <= rates) & (rates <= found[:, 1])
    assert np.min(np.sum(chances * held, axis=1)) >= LEAST_COVERAGE


def some_hard(generator, size):
    return np.where(generator.random(size) < 0.1, generator.uniform(0, 0.6, size), 1.0)


ACCURACIES = {
    **{
        f"mean {mean}": (
            mean,
            lambda generator, size, mean=mean: generator.beta(4 * mean, 4 * (1 - mean), size),
        )
        for mean in (0.6, 0.81, 0.95, 0.985, 0.998)
    },
    "a tenth is hard": (0.93, some_hard),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", ACCURACIES)
@pytest.mark.parametrize(
    ("objects", "trials"), [(12, 400), (20, 400), pytest.param(142, 250, marks=pytest.mark.long)]
)
def test_accuracies_are_covered(name, objects, trials):
    mean, draw = ACCURACIES[name]
    values = draw(np.random.default_rng(1), (trials, objects))
    found = np.array([ends(one, np.ones(objects)) for one in values])
    assert np.mean((found[:, 0] <= mean) & (mean <= found[:, 1])) >= LEAST_COVERAGE


@pytest.mark.slow
def test_normal_differences_are_covered():
    values = np.random.default_rng(4).normal(0.05, 0.16, (600, 12))
    found = np.array([ends(one, EQUAL, DIFFERENCE) for one in values])
    assert np.mean((found[:, 0] <= 0.05) & (found[:, 1] >= 0.05)) >= LEAST_COVERAGE


def worse_and_worse(values, worst, generator):
    """Make objects worse, one by one and by any amount, until all are as bad as possible."""
    values = values.copy()
    for place in generator.permutation(np.repeat(np.arange(len(values)), 2)):
        values[place] = generator.choice([worst, generator.uniform(worst, values[place])])
        yield values.copy()
    yield np.full(len(values), worst)


@pytest.mark.parametrize("weights", [EQUAL, UNEQUAL], ids=["equal", "unequal"])
@pytest.mark.parametrize("bounds", [SHARE, DIFFERENCE], ids=["share", "difference"])
@pytest.mark.parametrize("start", ["perfect", "equal", "near", "drawn"])
def test_no_end_rises_where_an_object_gets_worse(weights, bounds, start):
    generator = np.random.default_rng(7)
    starts = {
        "perfect": np.ones(12),
        "equal": np.full(12, 0.2),
        "near": 0.98 + generator.uniform(0, 0.02, 12),
        "drawn": generator.uniform(*bounds, 12),
    }
    before = ends(starts[start], weights, bounds)
    for values in worse_and_worse(starts[start], bounds[0], generator):
        after = ends(values, weights, bounds)
        assert np.all(after <= before + 1e-9)
        before = after
    assert before[0] == pytest.approx(bounds[0])


def test_the_better_result_does_not_look_less_sure():
    perfect, nearly = ends(np.ones(12)), ends([1.0] * 10 + [0.98, 0.84])
    assert perfect[0] > 0.76
    assert nearly[0] <= perfect[0]


@pytest.mark.parametrize("weights", [EQUAL, UNEQUAL], ids=["equal", "unequal"])
def test_ends_that_objects_show_are_those_of_drawn_weights(weights):
    values = np.random.default_rng(8).beta(3, 1.5, 12)
    low, high = ends(values, weights)
    shown, error = drawn_low_end(values, weights, values.min())
    assert low == pytest.approx(shown, abs=4 * error)
    mirrored, error = drawn_low_end(-values, weights, -values.max())
    assert high == pytest.approx(-mirrored, abs=4 * error)


@pytest.mark.parametrize("weights", [EQUAL, UNEQUAL], ids=["equal", "unequal"])
def test_objects_that_agree_may_have_missed_some_that_do_not(weights):
    values = np.linspace(0.97, 0.99, 12)
    left, error = drawn_low_end(np.ones(12), weights, 0.0)
    assert ends(values, weights)[0] == pytest.approx(0.99 * left, abs=4 * error)
    # The weight that is left of the best object's difference; the rest is at the worst, or the best.
    low, high = ends(values - 0.97, weights, DIFFERENCE)
    assert low == pytest.approx(0.02 * left - (1 - left), abs=4 * error)
    assert high == pytest.approx(1 - left, abs=4 * error)


def test_without_bounds_only_what_objects_show_counts():
    values = np.linspace(0.97, 0.99, 12)
    low, high = ends(values, EQUAL, UNBOUNDED)
    assert 0.97 < low < 0.98 < high < 0.99
    shown, error = drawn_low_end(values, EQUAL, values.min())
    assert low == pytest.approx(shown, abs=4 * error)
    assert ends(np.full(12, 3.0), EQUAL, UNBOUNDED).tolist() == [3, 3]


def test_what_is_turned_round_has_its_ends_turned_round():
    values = np.random.default_rng(9).beta(8, 1, 12)
    low, high = ends(values, UNEQUAL)
    assert ends(1 - values, UNEQUAL) == pytest.approx([1 - high, 1 - low], abs=1e-9)
    # A difference is a share of the way from -1 to 1.
    assert ends(2 * values - 1, UNEQUAL, DIFFERENCE) == pytest.approx(
        [2 * low - 1, 2 * high - 1], abs=1e-9
    )


def test_more_confidence_reaches_further():
    low = ends(np.ones(12), parameters=IntervalParameters(confidence=0.8))[0]
    assert low == pytest.approx(beta.ppf(0.1, 12, 0.75))


@pytest.mark.parametrize(
    ("values", "weights", "mean"),
    [
        ([0.5] * 5, [1.0, 2.0, 3.0, 4.0, 5.0], 0.5),
        ([0.0, 1.0], [3.0, 1.0], 0.25),
        ([0.1] * 3, [0.1, 0.7, 0.3], 0.1),
    ],
)
def test_the_mean_is_weighted_and_lies_within(values, weights, mean):
    found = object_interval(np.array(values), np.array(weights), PARAMETERS)
    assert found.mean == pytest.approx(mean)
    assert 0 <= found.low < found.mean < found.high <= 1


def test_one_object_has_no_interval():
    found = object_interval(np.array([0.5]), np.array([2.0]), PARAMETERS)
    assert (found.mean, found.low, found.high) == pytest.approx((0.5, np.nan, np.nan), nan_ok=True)


def test_values_out_of_bounds_are_refused_and_roundings_are_not():
    with pytest.raises(
        ValueError, match=r"values are from -0.2 to 1.0; they must be within \(0.0, 1.0\)"
    ):
        ends([-0.2, *[1.0] * 11])
    assert ends([-1e-16, *[1 + 1e-16] * 11]) == pytest.approx(ends([0.0, *[1.0] * 11]))


def test_values_that_nearly_agree_have_the_ends_of_those_that_do():
    near = 0.5 + np.linspace(-1e-13, 1e-13, 12)
    assert ends(near) == pytest.approx(ends(np.full(12, 0.5)), abs=1e-9)
    assert ends([0.5 - 1e-15, *[0.5] * 11]) == pytest.approx([0.5 * MISSED, 1 - 0.5 * MISSED])


def test_the_balanced_interval_weighs_objects_by_their_class():
    values, classes = np.array([1.0, 1.0, 0.5, 0.25, 0.0]), np.array([0, 0, 0, 1, 2])
    found = balanced_interval(values, classes, PARAMETERS)
    assert found.mean == pytest.approx((2.5 / 3 + 0.25) / 3)
    weighted = object_interval(values, np.array([1, 1, 1, 3, 3]), PARAMETERS)
    assert vars(found) == pytest.approx(vars(weighted), rel=1e-9)
    plain = object_interval(values, np.ones(5), PARAMETERS)
    assert vars(balanced_interval(values, np.zeros(5), PARAMETERS)) == pytest.approx(vars(plain))


def test_no_difference_among_twelve_objects_is_no_proof_of_equality():
    same = np.linspace(0, 1, 12)
    comparison = compare_paired(same, same, EQUAL, PARAMETERS)
    found = (comparison.difference.low, comparison.difference.mean, comparison.difference.high)
    assert found == pytest.approx((MISSED - 1, 0, 1 - MISSED))
    assert comparison.p_value == 1


def test_p_value_counts_every_sign_change():
    generator = np.random.default_rng(1)
    first, second = generator.uniform(size=(2, 8))
    differences = first - second
    means = [abs(np.dot(signs, differences)) for signs in itertools.product([-1, 1], repeat=8)]
    expected = np.mean([mean >= abs(differences.sum()) - 1e-9 for mean in means])
    comparison = compare_paired(first, second, np.ones(8), PARAMETERS)
    assert comparison.exact
    assert comparison.p_value == pytest.approx(expected)
    assert comparison.difference.mean == pytest.approx(differences.mean())


def test_a_paired_difference_and_its_p_value_weigh_objects():
    first, second = np.array([0.9, 0.5, 0.7, 0.2]), np.array([0.1, 0.6, 0.4, 0.0])
    weights = np.array([1.0, 6.0, 1.0, 2.0])
    parts = np.array([0.8, -0.6, 0.3, 0.4])  # differences times weights
    sums = [abs(np.dot(signs, parts)) for signs in itertools.product([-1, 1], repeat=4)]
    comparison = compare_paired(first, second, weights, PARAMETERS)
    assert comparison.difference.mean == pytest.approx(0.9 / 10)
    assert comparison.p_value == np.mean([total >= 0.9 - 1e-9 for total in sums]) == 0.5
    unweighted = compare_paired(first, second, np.ones(4), PARAMETERS)
    assert unweighted.p_value == 0.25


def test_sampled_sign_changes_weigh_objects_too():
    generator = np.random.default_rng(6)
    first, second = generator.uniform(0.2, 1, 16), generator.uniform(0, 0.8, 16)
    weights = np.where(np.arange(16) < 3, 20.0, 1.0)
    every = compare_paired(first, second, weights, IntervalParameters(permutations=2**16))
    sampled = compare_paired(first, second, weights, PARAMETERS)
    assert (every.exact, sampled.exact) == (True, False)
    # Three standard errors of a share over 16384 sign changes are .012 at most.
    assert sampled.p_value == pytest.approx(every.p_value, abs=0.012)
    unweighted = compare_paired(first, second, np.ones(16), PARAMETERS)
    assert abs(unweighted.p_value - every.p_value) > 0.05


def test_many_objects_are_sampled_and_the_observed_one_counts():
    generator = np.random.default_rng(2)
    first = generator.uniform(0.6, 1, size=60)
    parameters = IntervalParameters(permutations=500)
    comparison = compare_paired(first, first - 0.5, np.ones(60), parameters)
    assert not comparison.exact
    assert comparison.p_value == 1 / 501


def test_p_values_of_the_sampled_test_are_uniform_where_nothing_differs():
    generator = np.random.default_rng(3)
    parameters = IntervalParameters(permutations=200)
    p_values = [
        compare_paired(*generator.uniform(size=(2, 20)), np.ones(20), parameters).p_value
        for _ in range(400)
    ]
    # Three standard errors of a share of .05 over 400 trials are .033.
    assert abs(np.mean(np.array(p_values) <= 0.05) - 0.05) < 0.033


def test_holm_as_by_hand():
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.9, 0.8]) == pytest.approx([1.0, 1.0])
    assert holm([]) == []
