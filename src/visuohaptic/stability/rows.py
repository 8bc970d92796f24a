"""Results as rows of the table of hard cases, and the sentences that name what was exceeded."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from visuohaptic.stability.findings import Result
from visuohaptic.tables.schema import build_table
from visuohaptic.tables.stability import STABILITY


def result_table(results: Iterable[Result], key: str = "/") -> pa.Table:
    """Give results, one for each tolerance, about an object, `class/name`, as rows of `tables.STABILITY`."""
    rows = list(results)
    category, name = key.split("/")
    tolerances = [result.tolerance for result in rows]
    return build_table(
        STABILITY,
        {
            "family": [result.name.split("/")[0] for result in rows],
            "requirement": [result.name.split("/", 1)[1] for result in rows],
            "class": category,
            "object": name,
            "cases": [result.cases for result in rows],
            "worst_error": [
                result.worst_error if np.isfinite(result.worst_error) else None for result in rows
            ],
            "tolerance": [tolerance.bound for tolerance in tolerances],
            "unit": [tolerance.unit for tolerance in tolerances],
            "reason": [tolerance.reason for tolerance in tolerances],
            "hardest": [result.hardest for result in rows],
            "drawing": [result.drawing for result in rows],
        },
    )


def broken_tolerances(paths: Iterable[str | Path]) -> list[str]:
    """Name the tolerances that were exceeded, in a sentence each, and each file that can't be read.

    The files were checked when they were written, and are not checked again: this is called at the end
    of each run.
    """
    return [sentence for path in paths for sentence in _broken_of(path)]


def _broken_of(path: str | Path) -> list[str]:
    try:
        rows = pq.ParquetFile(path).read().drop_columns(["drawing"]).to_pylist()
    except (OSError, KeyError, pa.ArrowInvalid) as error:
        return [
            f"{path} can't be read as a table of hard cases ({error}); delete it and run again."
        ]
    return [
        _sentence(row)
        for row in rows
        if row["worst_error"] is None or row["worst_error"] > row["tolerance"]
    ]


def _sentence(row: Mapping[str, Any]) -> str:
    owner = f"{row['class']}/{row['object']}: " if row["object"] else ""
    error = "not finite" if row["worst_error"] is None else f"{row['worst_error']:.2g}"
    return (
        f"{owner}{row['family']}, {row['requirement']}: the worst error is {error}, and "
        f"{row['tolerance']:.2g} is allowed ({row['unit']}); hardest case: {row['hardest']}."
    )
