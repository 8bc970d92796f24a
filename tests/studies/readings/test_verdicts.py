"""A verdict follows from tables by a rule; made-up tables give each of the four."""

import pytest

from readings.choices import OPPONENTS
from readings.design import (
    PARTS_ON_OTHERS,
    PARTS_ON_PAPER_SET,
    all_readings,
)
from readings.verdicts import SETS, Evidence, lead_evidence, verdict

SVM = "support_vector_machine"


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


def readings_of(parts, lead):
    """Make up rows of a table of readings, each lead with an interval of 3 points to either side."""
    return [
        {
            "reading": one.name,
            "part": one.part,
            **one.options,
            "random_probing": opponent,
            "classifier": classifier,
            "ahead": lead(one.options, opponent),
            "ahead_low": lead(one.options, opponent) - 0.03,
            "ahead_high": lead(one.options, opponent) + 0.03,
            "p_value": 0.01 if abs(lead(one.options, opponent)) > 0.03 else 0.5,
        }
        for one in all_readings()
        if one.part in parts
        for opponent in OPPONENTS
        for classifier in (SVM, "naive_bayes")
    ]


def tables(lead):
    return {
        "paper": readings_of(PARTS_ON_PAPER_SET, lead),
        "outside": readings_of(PARTS_ON_OTHERS, lead),
    }


def lead_of_one_map(options, _):
    return 0.1 if options["map_output"] in {"feature_groups", "lattice"} else -0.1


@pytest.mark.parametrize(
    ("lead", "expected"),
    [
        (lambda *_: 0.1, "yes"),
        (lambda *_: -0.1, "no"),
        (lambda *_: 0.01, "not shown"),
        (lead_of_one_map, "depends"),
    ],
)
def test_made_up_tables_give_each_verdict(lead, expected):
    assert verdict(lead_evidence(tables(lead), SVM)) == expected


def test_each_kind_of_random_touches_has_a_verdict_of_its_own():
    made_up = tables(lambda _, opponent: 0.1 if opponent == "anywhere" else -0.1)
    found = {name: verdict(lead_evidence(made_up, SVM, name)) for name in OPPONENTS}
    assert found == {"reachable": "no", "anywhere": "yes", "visible": "no", "walk": "no"}


def test_another_question_and_readings_without_figures_are_no_evidence():
    rows = readings_of(PARTS_ON_PAPER_SET, lambda *_: 0.1)
    asked = len([one for one in all_readings() if one.part in PARTS_ON_PAPER_SET])
    shuffled = len({row["reading"] for row in rows if row["order"] == "shuffled"})
    failed = rows[0] | {"ahead": None}
    found = lead_evidence({"paper": [failed, *rows]}, SVM)
    assert len(found) == asked - 12 - shuffled
