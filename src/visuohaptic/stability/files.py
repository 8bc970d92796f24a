"""From hard cases to the table of them."""

from __future__ import annotations

from pathlib import Path

from visuohaptic.stability.checks import CHECKS, run_check
from visuohaptic.stability.findings import merge_results
from visuohaptic.stability.rows import result_table
from visuohaptic.tables.schema import write_table
from visuohaptic.tables.stability import STABILITY


def make_stability(output: str | Path, seed: int) -> None:
    """Make every check at its reduced count, and write the table.

    No error is raised where a tolerance is exceeded: the table says so.
    """
    found = [run_check(check, seed, check.draws).values() for check in CHECKS]
    merged = merge_results(result for results in found for result in results)
    write_table(STABILITY, result_table(merged.values(), "reduced"), output)
