"""A verdict follows from tables by a rule; made-up evidence gives each of the three."""

import itertools

import pytest

from variants.verdicts import SETS, Evidence, verdict


def evidence_of(objects, variant, mean, width):
    return Evidence(objects, variant, mean, 0.5 - 0.49 * (abs(mean) > width))


def four(*differences, width=0.03):
    """Return the default and the literal variant on both sets; None is not measured."""
    places = itertools.product(SETS, ("default", "literal"))
    found = zip(places, differences, strict=True)
    return [evidence_of(*place, mean, width) for place, mean in found if mean is not None]


def others(ahead, behind, neither, objects="paper"):
    means = [0.1] * ahead + [-0.1] * behind + [0.001] * neither
    return [evidence_of(objects, "other", mean, 0.05) for mean in means]


GAINS = four(0.01, 0.01, 0.01, 0.01)


@pytest.mark.parametrize(
    ("evidence", "expected"),
    [
        (four(0.1, 0.04, 0.2, 0.05), "yes"),
        (four(-0.1, -0.02, -0.2, -0.011), "not shown"),
        (four(-0.1, -0.1, -0.1, -0.1), "not shown"),
        # Small gains for sure are no gain worth having, but they are gains.
        (four(0.01, 0.01, 0.01, 0.01, width=0.005), "yes"),
        (four(0.1, 0.1, -0.1, 0.1), "depends"),
        (four(0.1, 0.1, 0.1, 0.01), "not shown"),
        (four(0.1, 0.1, 0.1, None), "not shown"),
        (four(-0.1, -0.1, None, None), "not shown"),
        ([], "not shown"),
        (GAINS + others(10, 10, 80), "depends"),
        (GAINS + others(10, 4, 86), "not shown"),
        (GAINS + others(10, 0, 5) + others(0, 10, 5, "outside"), "not shown"),
        (four(0.1, 0.1, 0.1, 0.1) + others(10, 10, 80), "yes"),
    ],
)
def test_the_first_rule_that_holds_gives_the_verdict(evidence, expected):
    assert verdict(evidence) == expected
    assert verdict(reversed(evidence)) == expected
