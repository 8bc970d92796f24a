"""A paired test that is one-sided, or whose p values are not uniform, is found."""

import dataclasses

import numpy as np
import pytest

from visuohaptic.guards import p_values
from visuohaptic.guards.p_values import guard_signs


def found(objects=12):
    return guard_signs(np.ones(objects), np.random.default_rng(0)).outcome


@pytest.mark.parametrize("objects", [5, 8, 12, 100])
def test_the_two_sided_test_holds(objects):
    assert found(objects) == "held"


def one_sided(apart, p):
    return p / 2 if apart.sum() > 0 else 1 - p / 2


@pytest.mark.parametrize(
    "change", [one_sided, lambda _, p: p / 2, lambda _, p: 1.0, lambda _, p: p**2]
)
def test_p_values_that_are_one_sided_or_not_uniform_are_found(monkeypatch, change):
    honest = p_values.compare_paired

    def wrong(first, second, *more):
        paired = honest(first, second, *more)
        return dataclasses.replace(paired, p_value=change(first - second, paired.p_value))

    monkeypatch.setattr(p_values, "compare_paired", wrong)
    assert found() == "failed"


def test_too_few_objects_are_not_tested():
    assert found(objects=4) == "not tested"
