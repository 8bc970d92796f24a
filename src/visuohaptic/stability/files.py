"""From checks to the table of hard cases."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Literal

import numpy as np
import pyarrow as pa

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.geometry.surface import read_surface
from visuohaptic.scene.parameters import Scene
from visuohaptic.seeds import spawn_generator
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.stability.findings import Result, merge_results
from visuohaptic.tables.phases import FIXATIONS, TOUCHES
from visuohaptic.tables.schema import build_table, read_table, write_table
from visuohaptic.tables.stability import STABILITY

Count = Literal["reduced", "full"]


def make_stability(output: str | Path, seed: int) -> None:
    """Make every check at its reduced count, and write the table.

    No error is raised where a tolerance is exceeded: the table says so.
    """
    from visuohaptic.stability.checks import CHECKS, run_check

    found = [run_check(check, seed, check.draws).values() for check in CHECKS]
    merged = merge_results(result for results in found for result in results)
    write_table(STABILITY, result_table(merged.values(), "reduced"), output)


def make_object_stability(
    key: str,
    mesh: str | Path,
    fixations: str | Path | Sequence[str | Path],
    touches: str | Path | Sequence[str | Path],
    output: str | Path,
    attention: AttentionParameters,
    sensor: SensorParameters,
    scene: Scene,
    seed: int,
) -> None:
    """Make the checks on one object, and write the table; of an object set aside it has no rows."""
    from visuohaptic.stability.objects import SensedObject, check_object

    located = read_table(FIXATIONS, fixations)
    if not located.num_rows:
        write_table(STABILITY, STABILITY.arrow.empty_table(), output)
        return
    felt = read_table(TOUCHES, touches)
    sensed = SensedObject(read_surface(mesh), located, felt, attention, sensor, scene, seed)
    found = check_object(sensed, spawn_generator(seed, "stability", key))
    write_table(STABILITY, result_table(found.values(), "reduced", key), output)


def result_table(results: Iterable[Result], count: Count, key: str = "/") -> pa.Table:
    """Give results as a table.

    Parameters
    ----------
    results : iterable of Result
        One for each tolerance.
    count : str
        How many cases were drawn: ``reduced`` or ``full``.
    key : str
        `class/name` of the object that they are about.

    Returns
    -------
    pyarrow.Table
        Rows of `tables.STABILITY`, one a result.
    """
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
            "count": count,
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


def broken_tolerances(paths: str | Path | Sequence[str | Path]) -> list[str]:
    """Name the tolerances that were exceeded.

    Parameters
    ----------
    paths : path or sequence of path
        Files of the table.

    Returns
    -------
    list of str
        One sentence each, which names the object if it is about one.

    Raises
    ------
    TableError
        If there is no such file, or the table breaks its schema.
    """
    rows = read_table(STABILITY, paths).drop_columns(["drawing"]).to_pylist()
    return [
        _sentence(row)
        for row in rows
        if row["worst_error"] is None or row["worst_error"] > row["tolerance"]
    ]


def _sentence(row: dict[str, object]) -> str:
    owner = f"{row['class']}/{row['object']}: " if row["object"] else ""
    error = "not finite" if row["worst_error"] is None else f"{row['worst_error']:.2g}"
    return (
        f"{owner}{row['family']}, {row['requirement']}: the worst error is {error}, and "
        f"{row['tolerance']:.2g} is allowed ({row['unit']}); hardest case: {row['hardest']}."
    )
