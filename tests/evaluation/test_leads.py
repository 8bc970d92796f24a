"""Intervals and p values of leads never disagree, and hold the truth as often as stated; so do those of new classes."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from visuohaptic.evaluation import student
from visuohaptic.evaluation.intervals import (
    DIFFERENCE,
    EXTRA,
    UNBOUNDED,
    balanced_class_interval,
    class_interval,
    compare_differences,
    compare_paired,
    object_interval,
    plain_comparison,
)
from visuohaptic.evaluation.sign_changes import _sign_changes, sign_change_test
from visuohaptic.recognition.parameters import IntervalParameters

PARAMETERS = IntervalParameters()
LUMPY = st.sampled_from([-1.0, -0.5, -0.125, 0.0, 0.0, 0.125, 0.5, 1.0])
SMOOTH = st.floats(-1, 1).map(lambda value: round(value, 6))
STEADY = st.floats(0.2, 0.9).map(lambda value: round(value, 3))
WEIGHTS = st.one_of(st.just(1.0), st.floats(0.25, 8))


@st.composite
def leads(draw, most=40):
    """Draw differences, weights, classes and parameters of one lead."""
    kind = draw(st.sampled_from([LUMPY, SMOOTH, STEADY, st.one_of(LUMPY, STEADY)]))
    values = np.array(draw(st.lists(kind, min_size=2, max_size=most)))
    size = {"min_size": len(values), "max_size": len(values)}
    equal = draw(st.booleans())
    weights = np.ones(len(values)) if equal else np.array(draw(st.lists(WEIGHTS, **size)))
    classes = draw(st.lists(st.sampled_from("abcdef"), **size))
    confidence = draw(st.sampled_from([0.5, 0.8, 0.9, 0.95, 0.99]))
    parameters = IntervalParameters(
        confidence=confidence, permutations=draw(st.sampled_from([100, 199, 1024, 4096]))
    )
    return values, weights, classes, parameters


def compared(values, weights=None, classes=None, parameters=PARAMETERS, bounds=DIFFERENCE):
    values = np.array(values, dtype=float)
    weights = np.ones(len(values)) if weights is None else weights
    return compare_differences(values, weights, parameters, bounds, classes)


def ends(interval):
    return np.array([interval.low, interval.high])


def excludes_zero(interval):
    return interval.low > 0 or interval.high < 0


def p_of_all_sign_changes(values, weights, mean=0.0):
    parts = (values - mean) * weights / weights.sum()
    sums = [abs(np.dot(signs, parts)) for signs in itertools.product([-1, 1], repeat=len(parts))]
    return np.mean([total >= abs(parts.sum()) - 1e-12 for total in sums])


@settings(max_examples=300)
@given(leads())
def test_interval_and_p_value_never_disagree(lead):
    values, weights, classes, parameters = lead
    found = compared(values, weights, classes, parameters)
    significance = round(1 - parameters.confidence, 12)
    assert (found.p_value < significance) == excludes_zero(found.difference)
    if found.classes > 1:
        wide = found.difference_new_classes
        assert (found.p_value_new_classes < significance) == excludes_zero(wide)
        assert found.p_value_new_classes >= found.p_value


@settings(max_examples=200)
@given(leads())
def test_intervals_hold_the_mean_and_lie_within_the_bounds(lead):
    values, weights, classes, parameters = lead
    found = compared(values, weights, classes, parameters)
    near, wide = found.difference, found.difference_new_classes
    assert -1 <= near.low <= near.mean <= near.high <= 1
    assert near.mean == wide.mean == pytest.approx(np.average(values, weights=weights))
    if found.classes > 1:
        assert -1 <= wide.low <= near.low <= near.high <= wide.high <= 1
    else:
        assert np.isnan([wide.low, wide.high, found.p_value_new_classes]).all()


@settings(max_examples=100)
@given(leads(most=12), st.data())
def test_no_end_falls_where_a_difference_rises(lead, data):
    values, weights, _, parameters = lead
    before = ends(compared(values, weights, None, parameters).difference)
    higher = values.copy()
    place = data.draw(st.integers(0, len(values) - 1))
    higher[place] = data.draw(st.floats(values[place], 1))
    after = ends(compared(higher, weights, None, parameters).difference)
    assert np.all(after >= before - 1e-9)


@settings(max_examples=100)
@given(leads())
def test_only_ratios_of_weights_count(lead):
    values, weights, classes, parameters = lead
    found = compared(values, weights, classes, parameters)
    doubled = compared(values, 2 * weights, classes, parameters)
    assert plain_comparison(doubled) == plain_comparison(found)
    other = compared(values, 3 * weights, classes, parameters)
    assert ends(other.difference) == pytest.approx(ends(found.difference), abs=1e-9)
    assert other.p_value == pytest.approx(found.p_value, abs=1e-9)


@settings(max_examples=60)
@given(leads(most=10), st.randoms(use_true_random=False))
def test_the_order_of_objects_does_not_count_where_all_sign_changes_are_taken(lead, random):
    values, weights, classes, _ = lead
    order = list(range(len(values)))
    random.shuffle(order)
    found = compared(values, weights, classes)
    other = compared(values[order], weights[order], [classes[place] for place in order])
    for one, another in (
        (found.difference, other.difference),
        (found.difference_new_classes, other.difference_new_classes),
    ):
        assert ends(one) == pytest.approx(ends(another), abs=1e-9, nan_ok=True)
    assert other.p_value == pytest.approx(found.p_value, abs=1e-9)


@settings(max_examples=60)
@given(leads(most=20))
def test_the_lead_of_the_other_treatment_is_the_mirror_image(lead):
    values, weights, classes, parameters = lead
    found, other = (compared(each, weights, classes, parameters) for each in (values, -values))
    assert ends(other.difference) == pytest.approx(-ends(found.difference)[::-1], abs=1e-9)
    assert other.p_value == pytest.approx(found.p_value, abs=1e-9)


@settings(max_examples=40)
@given(leads(most=8), st.floats(-1, 1))
def test_the_ends_part_accepted_from_rejected_means(lead, mean):
    values, weights, _, parameters = lead
    significance = round(1 - parameters.confidence, 12)
    found = sign_change_test(values, weights / weights.sum(), 16384, significance)
    assert found.exact
    assert found.p_value == p_of_all_sign_changes(values, weights)
    for tested in (mean, *values, found.low - 1e-6, found.high + 1e-6):
        if math.isinf(tested) or min(abs(tested - found.low), abs(tested - found.high)) < 1e-7:
            continue
        accepted = p_of_all_sign_changes(values, weights, tested) >= significance
        assert accepted == (found.low < tested < found.high)


def test_the_p_value_is_the_larger_of_sign_changes_and_of_unobserved_failures():
    # Sign changes reject 0, but objects with a large loss may not have been among these twelve.
    small = np.full(12, 0.05)
    found = compared(small)
    unobserved = 2 * stats.beta.sf(0.05 / 1.05, EXTRA, 12)
    assert unobserved > 0.4 > p_of_all_sign_changes(small, np.ones(12))
    assert found.p_value == pytest.approx(unobserved, rel=1e-6)
    share = stats.beta.ppf(0.975, EXTRA, 12)
    assert found.difference.low == pytest.approx((1 - share) * 0.05 - share, abs=1e-9)
    large = np.linspace(0.5, 0.9, 12)
    assert compared(large).p_value == 2 / 2**12
    mixed = np.array([-0.2, 0.3, 0.25, 0.4, 0.1, -0.05, 0.6, 0.2, 0.1, 0.05, 0.3, -0.1])
    assert compared(mixed).p_value == p_of_all_sign_changes(mixed, np.ones(12))


@pytest.mark.parametrize("objects", [2, 3, 4, 5])
def test_sign_changes_of_up_to_five_objects_reject_nothing(objects):
    found = compared(np.full(objects, 0.9))
    assert (found.difference.low, found.difference.high) == (-1, 1)
    assert found.p_value >= 2 / 2**objects > 0.05


def test_six_objects_are_the_fewest_that_settle_a_lead():
    found = compared(np.linspace(0.7, 0.95, 6))
    assert 0 < found.difference.low <= 0.7
    assert found.p_value == 2 / 2**6


def test_a_single_object_has_no_interval():
    found = compared([0.5], classes=["a"])
    assert np.isnan([*ends(found.difference), *ends(found.difference_new_classes)]).all()
    assert (found.difference.mean, found.p_value, found.classes) == (0.5, 1, 1)
    plain = plain_comparison(found)
    assert plain["difference"] == {"mean": 0.5, "low": None, "high": None}
    assert plain["difference_new_classes"] == plain["difference"]
    assert plain["p_value_new_classes"] is None


def test_without_bounds_the_interval_is_that_of_sign_changes():
    values = np.array([3.0, 4.0, 5.0, 7.0, 2.0, 4.5])
    found = compared(values, bounds=UNBOUNDED)
    assert ends(found.difference) == pytest.approx([2, 7])
    assert found.p_value == 2 / 2**6
    few = compared(values[:3], bounds=UNBOUNDED)
    assert ends(few.difference).tolist() == [-math.inf, math.inf]


def test_differences_outside_the_bounds_are_refused():
    with pytest.raises(ValueError, match=r"values are from -1\.5 to 0\.0; they must be within"):
        compared([-1.5, 0.0])


def test_drawn_sign_changes_are_the_same_each_time():
    values = np.random.default_rng(8).uniform(-0.5, 0.8, 60)
    first = plain_comparison(compared(values))
    _sign_changes.cache_clear()
    assert plain_comparison(compared(values)) == first
    assert not first["exact"]


@pytest.mark.parametrize("objects", [15, 40, 142])
def test_many_drawn_differences_have_nearly_students_interval(objects):
    values = np.random.default_rng(9).normal(0.05, 0.2, objects).clip(-1, 1)
    reach = stats.t.ppf(0.975, objects - 1) * stats.sem(values)
    low, high = ends(compared(values).difference)
    sign_ends = sign_change_test(values, np.full(objects, 1 / objects), 16384, 0.05)
    assert (sign_ends.low, sign_ends.high) == pytest.approx(
        (values.mean() - reach, values.mean() + reach), abs=0.1 * reach
    )
    assert low <= sign_ends.low <= sign_ends.high <= high


@pytest.mark.slow
@pytest.mark.parametrize("lead", [0.0, 0.1])
@pytest.mark.parametrize("objects", [12, 40])
def test_normal_leads_are_held(lead, objects):
    values = np.random.default_rng(4).normal(lead, 0.2, (500, objects)).clip(-1, 1)
    held = [low <= lead <= high for low, high in (ends(compared(one).difference) for one in values)]
    # Three standard errors of a share of .95 over 500 trials are .029.
    assert np.mean(held) >= 0.95 - 0.029


@pytest.mark.parametrize("degrees", [1, 2, 3, 4, 7, 11, 30, 141])
def test_students_distribution_agrees_with_scipys(degrees):
    for value in np.linspace(0, 12, 41):
        expected = 2 * stats.t.sf(value, degrees)
        assert student.two_sided(value, 1.0, degrees) == pytest.approx(expected, abs=1e-12)
    for significance in (0.01, 0.05, 0.1, 0.5):
        expected = stats.t.isf(significance / 2, degrees)
        assert student.quantile(significance, degrees) == pytest.approx(expected, rel=1e-9)
    assert student.two_sided(0.0, 0.0, degrees) == 1
    assert student.two_sided(0.1, 0.0, degrees) == pytest.approx(0, abs=1e-15)


CLASSES = np.repeat(["bottle", "car", "cup", "lamp"], 3)


def test_leads_of_new_classes_are_students_of_the_means_of_classes():
    means = np.array([0.3, -0.1, 0.25, 0.4])
    values = np.repeat(means, 3) + np.tile([-0.05, 0, 0.05], 4)
    found = compared(values, classes=CLASSES)
    test = stats.ttest_1samp(means, 0)
    assert found.classes == 4
    assert found.p_value_new_classes == pytest.approx(test.pvalue)
    low, high = test.confidence_interval(0.95)
    assert ends(found.difference_new_classes) == pytest.approx([low, high])


def test_new_classes_are_never_more_certain_than_new_objects():
    # The means of classes agree, but their objects do not.
    values = np.tile([-0.6, 0.2, 0.9], 4)
    found = compared(values, classes=CLASSES)
    assert vars(found.difference_new_classes) == pytest.approx(vars(found.difference))
    accuracies = np.tile([0.2, 0.9, 1.0], 4)
    wide = class_interval(accuracies, np.ones(12), CLASSES, PARAMETERS)
    assert vars(wide) == pytest.approx(vars(object_interval(accuracies, np.ones(12), PARAMETERS)))


def test_accuracies_of_new_classes_vary_with_the_means_of_classes():
    means = np.array([0.7, 0.8, 0.5, 0.6])
    found = class_interval(np.repeat(means, 3), np.ones(12), CLASSES, PARAMETERS)
    low, high = stats.ttest_1samp(means, 0).confidence_interval(0.95)
    assert ends(found) == pytest.approx([low, high])
    perfect = class_interval(np.ones(12), np.ones(12), CLASSES, PARAMETERS)
    assert ends(perfect) == pytest.approx([1 - stats.beta.ppf(0.975, EXTRA, 12), 1])


def test_one_class_says_nothing_of_new_classes():
    found = class_interval(np.array([0.5, 0.9]), np.ones(2), ["cup", "cup"], PARAMETERS)
    assert found.mean == pytest.approx(0.7)
    assert np.isnan(ends(found)).all()


def test_classes_of_one_object_are_students_of_the_objects():
    values = np.array([0.1, 0.5, 0.4, -0.2, 0.3, 0.25, 0.6])
    found = compared(values, classes=range(7))
    test = stats.ttest_1samp(values, 0)
    assert found.p_value_new_classes == pytest.approx(max(test.pvalue, found.p_value))
    assert found.difference_new_classes.low <= test.confidence_interval(0.95).low + 1e-12


def test_classes_of_unequal_weight_have_the_variance_of_the_weighted_mean():
    weights = np.array([1.0, 2.0, 3.0, 6.0])
    reaches = []
    for means in np.random.default_rng(3).normal(0, 0.1, (400, 4)):
        found = class_interval(means, weights, [0, 1, 2, 3], PARAMETERS, UNBOUNDED)
        reaches.append(found.high - found.mean)
    # Student's interval is wider than that of new objects, so its reach is the quantile times the standard error.
    # Three standard errors of the variance are .13.
    squares = np.square(np.array(reaches) / student.quantile(0.05, 3))
    variance = 0.01 * np.sum((weights / weights.sum()) ** 2)
    assert np.mean(squares) == pytest.approx(variance, rel=0.13)


def test_balanced_means_have_intervals_of_new_classes():
    values, classes = np.array([1.0, 1.0, 0.5, 0.25, 0.0]), np.array([0, 0, 0, 1, 2])
    found = balanced_class_interval(values, classes, PARAMETERS)
    expected = class_interval(values, np.array([1, 1, 1, 3, 3]) / 3, classes, PARAMETERS)
    assert vars(found) == pytest.approx(vars(expected))


def test_compare_paired_takes_first_minus_second():
    first, second = np.linspace(0.5, 1, 8), np.linspace(0.6, 0.3, 8)
    found = compare_paired(first, second, np.ones(8), PARAMETERS, list("aabbccdd"))
    expected = compared(first - second, classes=list("aabbccdd"))
    assert found == expected
