"""A verdict follows from tables by a rule; made-up evidence gives each of the four."""

import pytest

from readings.verdicts import SETS, Evidence, verdict


def four(*differences, width=0.03):
    """Give the default and the literal reading on both sets; None is not measured."""
    places = [(name, reading) for name in SETS for reading in ("default", "literal")]
    return [
        Evidence(*place, mean, mean - width, mean + width, 0.01 if abs(mean) > width else 0.5)
        for place, mean in zip(places, differences, strict=True)
        if mean is not None
    ]


def others(ahead, behind, neither, objects="paper"):
    signs = [0.1] * ahead + [-0.1] * behind + [0.001] * neither
    return [
        Evidence(
            objects, "other", mean, mean - 0.05, mean + 0.05, 0.01 if abs(mean) > 0.05 else 0.6
        )
        for mean in signs
    ]


@pytest.mark.parametrize(
    ("evidence", "expected"),
    [
        (four(0.1, 0.04, 0.2, 0.05), "yes"),
        (four(-0.1, -0.02, -0.2, -0.011), "no"),
        (four(0.0, 0.005, -0.005, 0.001, width=0.01), "no"),
        # Small gains for sure are no gain worth having, but they are gains.
        (four(0.01, 0.01, 0.01, 0.01, width=0.005), "yes"),
        (four(0.1, 0.1, -0.1, 0.1), "depends"),
        (four(0.1, 0.1, 0.1, 0.01), "not shown"),
        (four(0.1, 0.1, 0.1, None), "not shown"),
        (four(-0.1, -0.1, None, None), "not shown"),
        ([], "not shown"),
        (four(0.01, 0.01, 0.01, 0.01) + others(10, 10, 80), "depends"),
        (four(0.01, 0.01, 0.01, 0.01) + others(10, 4, 86), "not shown"),
        (
            four(0.01, 0.01, 0.01, 0.01) + others(10, 0, 5) + others(0, 10, 5, "outside"),
            "not shown",
        ),
        (four(0.1, 0.1, 0.1, 0.1) + others(10, 10, 80), "yes"),
    ],
)
def test_the_first_rule_that_holds_gives_the_verdict(evidence, expected):
    assert verdict(evidence) == expected
    assert verdict(reversed(evidence)) == expected
