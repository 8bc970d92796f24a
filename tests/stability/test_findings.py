"""The worst of many errors is kept with its case, becomes a row, and is named in a sentence if it is too large."""

import numpy as np

from visuohaptic.stability.findings import Finding, merge_results, results_of
from visuohaptic.stability.rows import broken_tolerances, result_table
from visuohaptic.stability.tolerances import TOLERANCES
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.stability import STABILITY

NAME = "frames of touches"
OTHER = "touches by themselves"


def results(*findings):
    return list(results_of(findings, TOLERANCES))


def test_the_worst_error_is_kept_with_its_case():
    errors = Finding(NAME, [0.1, 3.0, 2.0], lambda row: f"case {row}")
    (result,) = results(errors)
    assert (result.worst_error, result.cases, result.hardest) == (3.0, 3, "case 1")
    assert not result.held


def test_what_is_no_number_is_an_infinite_error_and_no_case_no_result():
    found = results(Finding(NAME, [0.0, np.nan]), Finding(NAME, []), Finding(NAME, True))
    assert [result.worst_error for result in found] == [np.inf, 1.0]


def test_an_error_of_the_tolerance_itself_holds():
    bound = TOLERANCES[NAME].bound
    errors = (bound, np.nextafter(bound, 1))
    assert [one.held for one in results(*(Finding(NAME, e) for e in errors))] == [True, False]


def test_merging_sums_cases_and_keeps_the_worst_in_the_order_of_their_coming():
    first, second = Finding(OTHER, [0, 0], "a"), Finding(NAME, [1.0, 2.0], "b")
    merged = merge_results(results(first, second, Finding(NAME, [5.0, 0, 0], "c")))
    assert list(merged) == [OTHER, NAME]
    assert (merged[NAME].cases, merged[NAME].worst_error, merged[NAME].hardest) == (5, 5.0, "c")


def written(path, key, **errors):
    findings = [Finding(name, error, "the case") for name, error in errors.items()]
    write_table(STABILITY, result_table(results(*findings), key), path)
    return path


def test_a_row_has_tolerance_reason_and_object(tmp_path):
    path = written(tmp_path / "part.parquet", "cup/mug", **{"frames of touches": 1e-16})
    (row,) = read_table(STABILITY, path).to_pylist()
    assert row["requirement"] == "frames of touches"
    assert (row["class"], row["object"]) == ("cup", "mug")
    assert row["worst_error"] == 1e-16 < row["tolerance"]
    assert "square" in row["reason"]


def test_what_was_exceeded_is_named_at_its_object_and_a_file_that_can_not_be_read(tmp_path):
    own = written(tmp_path / "own.parquet", "cup/mug", **{"touches by themselves": 1})
    sound = {"rays against brute force in float64": 0}
    other = {"frames of touches": np.inf}
    infinite = written(tmp_path / "part.parquet", "cup/jug", **other, **sound)
    half = tmp_path / "half.parquet"
    half.write_text("half")
    first, second, third = broken_tolerances([infinite, own, half])
    assert first.startswith("cup/jug: frames of touches: the worst error is not finite, and 3.6")
    assert second.startswith("cup/mug: touches by themselves: the worst error is 1, and 0")
    assert third.startswith(f"{half} can't be read as a table of checks (")
    assert third.endswith(f"); run `snakemake -j2 --force {half}` to write it again.")
