"""What the numerical suite found in hard cases, and what accuracy of each kernel costs."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from markupsafe import Markup

from visuohaptic.errors import ReportError

_PLAIN = {"case": "", "tolerance": None, "unit": "", "reason": "", "hardest": ""}
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
    case, unit, reason, hardest : str
        What was wanted, the error's unit, why its tolerance is what it is, and the worst case.
    cases : int
        How many were tried.
    worst_error : float or None
        None where it was not a number.
    tolerance : float or None
        The largest error that is allowed; None where none is named.
    drawing : str
        The worst case as SVG, safe to be shown; may be empty.
    """

    case: str
    cases: int
    worst_error: float | None
    tolerance: float | None
    unit: str
    reason: str
    hardest: str
    drawing: str

    @property
    def held(self) -> bool:
        """Whether the worst error is within its tolerance."""
        if self.tolerance is None:
            return True
        return self.worst_error is not None and self.worst_error <= self.tolerance


@dataclass(frozen=True)
class StabilityFigures:
    """All that the suite wrote: checks by family, and its further tables."""

    families: Mapping[str, list[Check]]
    tables: Mapping[str, list[Mapping[str, Any]]]

    @property
    def cases(self) -> int:
        """Number of all cases that were tried."""
        return sum(check.cases for checks in self.families.values() for check in checks)

    @property
    def broken(self) -> list[Check]:
        """Checks whose tolerance was exceeded."""
        return [check for checks in self.families.values() for check in checks if not check.held]


def read_stability(path: str | Path | None) -> StabilityFigures | None:
    """Read what the numerical suite wrote.

    Parameters
    ----------
    path : path or None
        `reports/stability.json`: checks and further tables, or a list of checks alone.

    Returns
    -------
    StabilityFigures or None
        None where there is no such file.

    Raises
    ------
    ReportError
        If the file is there but is not the suite's.
    """
    data = _read_json(path)
    if data is None:
        return None
    try:
        data = {"checks": data} if isinstance(data, list) else data
        families: dict[str, list[Check]] = {}
        for record in data["checks"]:
            families.setdefault(record["family"], []).append(_read_check(record))
        tables = {
            name: rows for name, rows in data.items() if name != "checks" and isinstance(rows, list)
        }
    except (KeyError, TypeError, AttributeError) as error:
        raise ReportError(
            f"{path} holds no results of the numerical suite ({error}); run make test-hard again."
        ) from error
    return StabilityFigures(families, tables)


def _read_check(record: Mapping[str, Any]) -> Check:
    named = {name: record.get(name, plain) for name, plain in _PLAIN.items()}
    drawing = _safe_drawing(str(record.get("drawing", "")))
    return Check(cases=record["cases"], worst_error=record["worst_error"], drawing=drawing, **named)


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
