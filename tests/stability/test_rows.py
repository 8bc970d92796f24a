"""Results become rows of the table, and what was exceeded becomes sentences."""

import numpy as np

from visuohaptic.stability.findings import Finding, results_of
from visuohaptic.stability.rows import broken_tolerances, result_table
from visuohaptic.stability.tolerances import TOLERANCES
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.stability import STABILITY


def written(path, key="/", **errors):
    findings = [Finding(f"objects/{name}", error, "the case") for name, error in errors.items()]
    write_table(STABILITY, result_table(results_of(findings, TOLERANCES), key), path)
    return path


def test_a_row_has_tolerance_reason_and_object(tmp_path):
    path = written(tmp_path / "part.parquet", "cup/mug", **{"frames of touches": 1e-16})
    (row,) = read_table(STABILITY, path).to_pylist()
    assert (row["family"], row["requirement"]) == ("objects", "frames of touches")
    assert (row["class"], row["object"]) == ("cup", "mug")
    assert row["worst_error"] == 1e-16 < row["tolerance"]
    assert "square" in row["reason"]


def test_what_was_exceeded_is_named_at_its_object_and_a_file_that_can_not_be_read(tmp_path):
    own = written(tmp_path / "own.parquet", "cup/mug", **{"touches by themselves": 1})
    sound = {"rays against brute force in float64": 0}
    plain = written(tmp_path / "part.parquet", **{"frames of touches": np.inf}, **sound)
    half = tmp_path / "half.parquet"
    half.write_text("half")
    first, second, third = broken_tolerances([plain, own, half])
    assert first.startswith(
        "objects, frames of touches: the worst error is not finite, and 3.6e-15"
    )
    assert second.startswith("cup/mug: objects, touches by themselves: the worst error is 1, and 0")
    assert third.startswith(str(half))
