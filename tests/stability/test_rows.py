"""Results become rows of the table, and what was exceeded becomes sentences."""

import numpy as np

from visuohaptic.stability.findings import Finding, worst_of
from visuohaptic.stability.rows import broken_tolerances, result_table
from visuohaptic.stability.tolerances import TOLERANCES
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.stability import STABILITY

FRAMES = "objects/frames of touches"


def written(folder, errors, key="/", name="part.parquet"):
    results = [
        worst_of(Finding(tolerance, error, "the case"), TOLERANCES)
        for tolerance, error in errors.items()
    ]
    write_table(STABILITY, result_table(results, key), folder / name)
    return folder / name


def test_a_row_has_tolerance_reason_and_object(tmp_path):
    path = written(tmp_path, {FRAMES: 1e-16}, "cup/mug")
    (row,) = read_table(STABILITY, path).to_pylist()
    assert (row["family"], row["requirement"]) == ("objects", "frames of touches")
    assert (row["class"], row["object"]) == ("cup", "mug")
    assert row["worst_error"] == 1e-16 < row["tolerance"]
    assert "square" in row["reason"]


def test_an_exceeded_tolerance_is_named_at_its_object(tmp_path):
    own = written(tmp_path, {"objects/touches by themselves": 1}, "cup/mug", "own.parquet")
    plain = written(tmp_path, {FRAMES: np.inf, "objects/rays against brute force in float64": 0})
    first, second = broken_tolerances([plain, own])
    assert first == (
        "objects, frames of touches: the worst error is not finite, and 3.6e-15 is allowed (1); "
        "hardest case: the case."
    )
    assert second.startswith("cup/mug: objects, touches by themselves: the worst error is 1, and 0")


def test_a_file_that_can_not_be_read_is_named(tmp_path):
    (tmp_path / "half.parquet").write_text("half")
    (sentence,) = broken_tolerances([tmp_path / "half.parquet"])
    assert "half.parquet can't be read as a table of hard cases" in sentence
