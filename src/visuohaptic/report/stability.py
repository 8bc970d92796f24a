"""How exact numbers are, on the run's objects and in hard cases, and what accuracy of each kernel costs."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pyarrow as pa
from markupsafe import Markup

from visuohaptic.errors import ReportError
from visuohaptic.report.wording import counted, percent
from visuohaptic.tables.schema import read_table
from visuohaptic.tables.stability import STABILITY

# Elements and attributes that a drawing may have; all others are removed.
_DRAWING = re.compile(
    r"<svg (?: ?(?:viewBox|width|height|role|aria-label)=\"[^\"<>]*\")*>"
    r"(?:<(?:line|circle|rect|polygon|polyline)"
    r"(?: (?:x1|x2|y1|y2|x|y|cx|cy|r|width|height|points|fill|fill-opacity|stroke|stroke-width)"
    r"=\"[^\"<>]*\")*/>)*</svg>"
)


@dataclass(frozen=True)
class Check:
    """One kind of hard case: how many were tried, and how the worst of them went.

    Attributes
    ----------
    family, requirement, unit, reason, hardest : str
        What was wanted, the error's unit, why its tolerance is what it is, and the worst case.
    key : str
        `class/name` of the object that it is about; empty where it is about none.
    cases : int
        How many were tried.
    worst_error : float or None
        None where it was not finite.
    tolerance : float
        The largest error that is allowed.
    drawing : str
        The worst case as SVG, safe to be shown; may be empty.
    """

    family: str
    requirement: str
    key: str
    cases: int
    worst_error: float | None
    tolerance: float
    unit: str
    reason: str
    hardest: str
    drawing: str

    @property
    def held(self) -> bool:
        """Whether the worst error is within its tolerance."""
        return self.share <= 1

    @property
    def share(self) -> float:
        """The worst error over its tolerance; where 0 is allowed, 0 or infinite."""
        if self.worst_error is None:
            return float("inf")
        if self.tolerance == 0:
            return 0.0 if self.worst_error == 0 else float("inf")
        return self.worst_error / self.tolerance


@dataclass(frozen=True)
class StabilityFigures:
    """What was found in hard cases.

    Attributes
    ----------
    checks : tuple of Check
        One for each requirement, and for each object of those about objects.
    table : pyarrow.Table
        The same as rows of `tables.STABILITY`.
    """

    checks: tuple[Check, ...]
    table: pa.Table

    @property
    def families(self) -> dict[str, list[Check]]:
        """The worst check of each requirement over all objects, by family."""
        merged: dict[tuple[str, str], Check] = {}
        for check in self.checks:
            place = (check.family, check.requirement)
            merged[place] = _worse(merged[place], check) if place in merged else _named(check)
        found: dict[str, list[Check]] = {}
        for check in merged.values():
            found.setdefault(check.family, []).append(check)
        return found

    @property
    def objects(self) -> dict[str, list[Check]]:
        """Checks about an object, by `class/name`."""
        found: dict[str, list[Check]] = {}
        for check in self.checks:
            if check.key:
                found.setdefault(check.key, []).append(check)
        return found

    @property
    def cases(self) -> int:
        """Number of all cases that were tried."""
        return sum(check.cases for check in self.checks)

    @property
    def broken(self) -> list[Check]:
        """Checks whose tolerance was exceeded, each with its object."""
        return [check for check in self.checks if not check.held]


def _named(check: Check) -> Check:
    """Say in the hardest case which object it is about."""
    return replace(check, hardest=f"{check.key}: {check.hardest}") if check.key else check


def _worse(kept: Check, other: Check) -> Check:
    worse = _named(other) if other.share > kept.share else kept
    return replace(worse, cases=kept.cases + other.cases)


def read_stability(paths: Sequence[str | Path]) -> StabilityFigures | None:
    """Read tables of hard cases.

    Parameters
    ----------
    paths : sequence of path
        Files of the table, or folders of them; those that don't exist are left out.

    Returns
    -------
    StabilityFigures or None
        None where there is no file.

    Raises
    ------
    TableError
        If a file breaks the schema.
    """
    there = [path for path in map(Path, paths) if path.is_file() or any(path.rglob("*.parquet"))]
    if not there:
        return None
    return stability_figures(read_table(STABILITY, there))


def stability_figures(table: pa.Table) -> StabilityFigures:
    """Give the figures of rows of `tables.STABILITY`."""
    return StabilityFigures(tuple(map(_check, table.to_pylist())), table)


def _check(row: Mapping[str, Any]) -> Check:
    kept = {
        name: row[name] for name in Check.__dataclass_fields__ if name not in ("key", "drawing")
    }
    key = f"{row['class']}/{row['object']}" if row["object"] else ""
    return Check(key=key, drawing=_safe_drawing(row["drawing"]), **kept)


def describe_checks(checks: Iterable[Check]) -> str:
    """Say in a sentence or two how many cases were tried, and which came nearest to its tolerance."""
    found = list(checks)
    cases = counted(sum(check.cases for check in found), "hard case")
    kinds = {(check.family, check.requirement) for check in found}
    tried = f"{cases} of {counted(len(kinds), 'kind')}"
    broken = [check for check in found if not check.held]
    if broken:
        names = "; ".join(dict.fromkeys(_title(check) for check in broken))
        return f"{tried}: {counted(len(broken), 'tolerance')} exceeded ({names})."
    worst = max(found, key=lambda check: check.share)
    exact = kinds - {(check.family, check.requirement) for check in found if check.share > 0}
    return (
        f"{tried} were tried, and every error is within its tolerance; {counted(len(exact), 'kind')} "
        f"{'has' if len(exact) == 1 else 'have'} no error at all. The largest error, as a share of what "
        f"is allowed, is {percent(worst.share, 2)} ({_title(worst)})."
    )


def _title(check: Check) -> str:
    return ": ".join(filter(None, (check.key, f"{check.family}, {check.requirement}")))


def stability_answer(figures: Sequence[StabilityFigures]) -> str:
    """Say how many cases were tried, and how near the worst came to its tolerance.

    `figures` are those found on the run's objects, and in hard cases of the code.
    """
    checks = [check for part in figures for check in part.checks]
    if any(not check.held for check in checks):
        return describe_checks(checks)
    cases = counted(sum(check.cases for check in checks), "hard case")
    return f"{cases} tried; every error is within its tolerance."


def read_precision(path: str | Path | None) -> dict[str, list[Mapping[str, Any]]]:
    """Read errors and seconds of each kernel's settings.

    Parameters
    ----------
    path : path or None
        `reports/precision.json`.

    Returns
    -------
    dict of str to list
        Rows by kernel; empty where there is no such file.

    Raises
    ------
    ReportError
        If the file is there but holds no such rows.
    """
    rows = _read_json(path) or []
    kernels: dict[str, list[Mapping[str, Any]]] = {}
    try:
        for row in rows:
            kernels.setdefault(row["kernel"], []).append(row)
    except (KeyError, TypeError) as error:
        raise ReportError(
            f"{path} holds no rows of kernels ({error}); run make test-hard again."
        ) from error
    return kernels


def _read_json(path: str | Path | None) -> Any:
    if path is None or not Path(path).exists():
        return None
    try:
        return json.loads(Path(path).read_text(encoding="utf-8"))
    except ValueError as error:
        raise ReportError(f"{path} is no JSON ({error}); make it again.") from error


def _safe_drawing(svg: str) -> str:
    """Let a drawing onto the page only if it is plain shapes: the file may be anyone's."""
    return Markup(svg) if _DRAWING.fullmatch(svg) else ""  # noqa: S704
