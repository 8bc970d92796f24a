"""Of many errors the worst is kept, with its case."""

import numpy as np

from visuohaptic.stability.findings import Finding, merge_results, results_of
from visuohaptic.stability.tolerances import TOLERANCES

NAME = "objects/frames of touches"
OTHER = "objects/touches by themselves"


def results(*findings):
    return list(results_of(findings, TOLERANCES))


def test_the_worst_error_is_kept_with_its_case_and_drawing():
    (result,) = results(
        Finding(NAME, [0.1, 3.0, 2.0], lambda row: f"case {row}", lambda row: "<svg>")
    )
    assert (result.worst_error, result.cases, result.hardest) == (3.0, 3, "case 1")
    assert result.drawing == "<svg>"
    assert not result.held


def test_what_is_no_number_is_an_infinite_error_and_no_case_no_result():
    found = results(Finding(NAME, [0.0, np.nan]), Finding(NAME, []), Finding(NAME, True))
    assert [result.worst_error for result in found] == [np.inf, 1.0]


def test_an_error_of_the_tolerance_itself_holds():
    bound = TOLERANCES[NAME].bound
    errors = (bound, np.nextafter(bound, 1))
    assert [one.held for one in results(*(Finding(NAME, e) for e in errors))] == [True, False]


def test_merging_sums_cases_and_keeps_the_worst_in_the_order_of_their_coming():
    found = results(
        Finding(OTHER, [0, 0], "a"),
        Finding(NAME, [1.0, 2.0], "b"),
        Finding(NAME, [5.0, 0, 0], "c"),
    )
    merged = merge_results(found)
    assert list(merged) == [OTHER, NAME]
    assert (merged[NAME].cases, merged[NAME].worst_error, merged[NAME].hardest) == (5, 5.0, "c")
