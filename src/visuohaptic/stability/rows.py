"""Results as rows of the table of checks, and sentences on exceeded tolerances."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from visuohaptic.base.errors import TableError
from visuohaptic.stability.findings import Result
from visuohaptic.tables.phases import owner_columns
from visuohaptic.tables.schema import build_rows, open_parquet
from visuohaptic.tables.stability import STABILITY


def result_table(results: Iterable[Result], key: str) -> pa.Table:
    """Return the results of one object as rows of `tables.STABILITY`, one row per tolerance.

    `key` is the object, `class/name`. An infinite error becomes a missing value.
    """
    rows = [
        {
            **owner_columns(key),
            "requirement": result.name,
            "cases": result.cases,
            "worst_error": result.worst_error if np.isfinite(result.worst_error) else None,
            "tolerance": result.tolerance.bound,
            "unit": result.tolerance.unit,
            "reason": result.tolerance.reason,
            "hardest": result.hardest,
        }
        for result in results
    ]
    return build_rows(STABILITY, rows)


def broken_tolerances(paths: Iterable[str | Path]) -> list[str]:
    """Return one sentence per exceeded tolerance and per file that can't be read.

    `paths` are files of `tables.STABILITY`. The rows are not checked against the schema again: the end of each
    run calls this function, and the files were checked when they were written.
    """
    sentences = []
    for path in paths:
        try:
            rows = open_parquet(path).read().to_pylist()
        except (OSError, TableError, pa.ArrowInvalid) as error:
            rows = []
            sentences.append(
                f"{path} can't be read as a table of checks ({str(error).rstrip('.')}); run "
                f"`snakemake -j2 --force {path}` to write it again."
            )
        sentences += [_sentence(row) for row in rows if not _held(row)]
    return sentences


def _held(row: Mapping[str, Any]) -> bool:
    return row["worst_error"] is not None and row["worst_error"] <= row["tolerance"]


def _sentence(row: Mapping[str, Any]) -> str:
    error = "not finite" if row["worst_error"] is None else f"{row['worst_error']:.2g}"
    return (
        f"{row['class']}/{row['object']}: {row['requirement']}: the worst error is {error}, and "
        f"{row['tolerance']:.2g} is allowed ({row['unit']}); hardest case: {row['hardest']}."
    )
