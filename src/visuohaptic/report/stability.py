"""How exact numbers are, on the run's objects and in hard cases, and what accuracy of each kernel costs."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import pyarrow as pa
from markupsafe import Markup

from visuohaptic.report.estimates import Row, read_json
from visuohaptic.report.wording import counted, percent

# Elements and attributes that a drawing may have; all others are removed.
_DRAWING = re.compile(
    r"<svg (?: ?(?:viewBox|width|height|role|aria-label)=\"[^\"<>]*\")*>"
    r"(?:<(?:line|circle|rect|polygon|polyline)"
    r"(?: (?:x1|x2|y1|y2|x|y|cx|cy|r|width|height|points|fill|fill-opacity|stroke|stroke-width)"
    r"=\"[^\"<>]*\")*/>)*</svg>"
)


@dataclass(frozen=True)
class Check:
    """A row of `tables.STABILITY`; `key` is `class/name` of its object, or empty, and `drawing` safe to be shown."""

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
        if self.worst_error == 0:
            return 0.0
        if self.worst_error is None or self.tolerance == 0:
            return float("inf")
        return self.worst_error / self.tolerance

    @property
    def kind(self) -> tuple[str, str]:
        """What is required, of all objects."""
        return self.family, self.requirement

    @property
    def title(self) -> str:
        """Its kind in words, and its object."""
        return ": ".join(filter(None, (self.key, ", ".join(self.kind))))


@dataclass(frozen=True)
class StabilityFigures:
    """Checks: one for each requirement, and for each object of those about objects; `table` has them as rows."""

    checks: tuple[Check, ...]
    table: pa.Table

    @property
    def families(self) -> dict[str, list[Check]]:
        """The worst check of each requirement over all objects, by family."""
        found: dict[str, list[Check]] = {}
        for kind in dict.fromkeys(check.kind for check in self.checks):
            own = [check for check in self.checks if check.kind == kind]
            worst = max(own, key=lambda check: check.share)
            hardest = ": ".join(filter(None, (worst.key, worst.hardest)))
            cases = sum(check.cases for check in own)
            found.setdefault(kind[0], []).append(replace(worst, cases=cases, hardest=hardest))
        return found

    @property
    def objects(self) -> dict[str, list[Check]]:
        """Checks about an object, by `class/name`."""
        keys = sorted({check.key for check in self.checks if check.key})
        return {key: [check for check in self.checks if check.key == key] for key in keys}

    @property
    def broken(self) -> list[Check]:
        """Checks whose tolerance was exceeded, each with its object."""
        return [check for check in self.checks if not check.held]


def stability_figures(table: pa.Table) -> StabilityFigures:
    """Give the figures of rows of `tables.STABILITY`."""
    return StabilityFigures(tuple(map(_check, table.to_pylist())), table)


def describe_checks(checks: Iterable[Check]) -> str:
    """Say in a sentence or two how many cases were tried, and which came nearest to its tolerance."""
    found = list(checks)
    cases = counted(sum(check.cases for check in found), "hard case")
    kinds = {check.kind for check in found}
    tried = f"{cases} of {counted(len(kinds), 'kind')}"
    broken = [check.title for check in found if not check.held]
    if broken:
        names = "; ".join(dict.fromkeys(broken))
        return f"{tried}: {counted(len(broken), 'tolerance')} exceeded ({names})."
    worst = max(found, key=lambda check: check.share)
    exact = len(kinds - {check.kind for check in found if check.share > 0})
    return (
        f"{tried} were tried, and every error is within its tolerance; {counted(exact, 'kind')} "
        f"{'has' if exact == 1 else 'have'} no error at all. The largest error, as a share of what "
        f"is allowed, is {percent(worst.share, 2)} ({worst.title})."
    )


def stability_answer(figures: Sequence[StabilityFigures]) -> str:
    """Say how many cases were tried, on the run's objects and of the code, and what was exceeded."""
    checks = [check for part in figures for check in part.checks]
    if any(not check.held for check in checks):
        return describe_checks(checks)
    cases = counted(sum(check.cases for check in checks), "numerically hard case")
    return f"{cases} computed; every error is within its tolerance."


def read_precision(path: Path) -> dict[str, list[Row]]:
    """Read errors and seconds of each kernel's settings, ``reports/precision.json``, by kernel."""

    def by_kernel(rows: Sequence[Row]) -> dict[str, list[Row]]:
        kernels = dict.fromkeys(row["kernel"] for row in rows)
        return {kernel: [row for row in rows if row["kernel"] == kernel] for kernel in kernels}

    return read_json(path, by_kernel, "holds no rows of kernels", "run make test-hard again")


def _check(row: Row) -> Check:
    names = set(Check.__dataclass_fields__) - {"key", "drawing"}
    # The file may be anyone's, so a drawing comes onto the page only if it is plain shapes.
    safe = Markup(row["drawing"]) if _DRAWING.fullmatch(row["drawing"]) else ""  # noqa: S704
    key = f"{row['class']}/{row['object']}" if row["object"] else ""
    return Check(key=key, drawing=safe, **{name: row[name] for name in names})
