"""Of many errors the worst is kept, with its case."""

import numpy as np

from visuohaptic.stability import findings
from visuohaptic.stability.findings import Finding, merge_results
from visuohaptic.stability.tolerances import TOLERANCES

NAME = "objects/frames of touches"
OTHER = "objects/touches by themselves"


def worst_of(finding):
    return findings.worst_of(finding, TOLERANCES)


def test_the_worst_error_is_kept_with_its_case_and_drawing():
    result = worst_of(
        Finding(NAME, [0.1, 3.0, 2.0], lambda row: f"case {row}", lambda row: "<svg>")
    )
    assert (result.worst_error, result.cases, result.hardest) == (3.0, 3, "case 1")
    assert result.drawing == "<svg>"
    assert not result.held


def test_what_is_no_number_is_an_infinite_error():
    assert worst_of(Finding(NAME, [0.0, np.nan])).worst_error == np.inf
    assert worst_of(Finding(NAME, True)).worst_error == 1.0


def test_an_error_of_the_tolerance_itself_holds():
    bound = worst_of(Finding(NAME, 0.0)).tolerance.bound
    assert worst_of(Finding(NAME, bound)).held
    assert not worst_of(Finding(NAME, np.nextafter(bound, 1))).held


def test_no_case_gives_no_result():
    assert worst_of(Finding(NAME, [])) is None


def test_merging_sums_cases_and_keeps_the_worst_in_the_order_of_their_coming():
    first = worst_of(Finding(OTHER, [0, 0], "a"))
    results = [
        first,
        worst_of(Finding(NAME, [1.0, 2.0], "b")),
        worst_of(Finding(NAME, 5.0, "c", cases=7)),
    ]
    merged = merge_results(results)
    assert list(merged) == [OTHER, NAME]
    assert (merged[NAME].cases, merged[NAME].worst_error, merged[NAME].hardest) == (9, 5.0, "c")
