"""Numerical errors beside their tolerances: on the run's objects, and in the hard cases of the code."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import pyarrow as pa

from visuohaptic.report.estimates import Row, read_json
from visuohaptic.report.wording import counted, percent


@dataclass(frozen=True)
class Check:
    """A row of `tables.STABILITY`; `key` is `class/name` of its object."""

    key: str
    requirement: str
    cases: int
    worst_error: float | None
    tolerance: float
    unit: str
    hardest: str

    @property
    def held(self) -> bool:
        """Whether the worst error is within its tolerance."""
        return self.share <= 1

    @property
    def share(self) -> float:
        """The worst error divided by its tolerance; infinite if the error is not finite or the tolerance is 0."""
        if self.worst_error == 0:
            return 0.0
        if self.worst_error is None or self.tolerance == 0:
            return float("inf")
        return self.worst_error / self.tolerance

    @property
    def title(self) -> str:
        """The object and the requirement."""
        return f"{self.key}: {self.requirement}"


@dataclass(frozen=True)
class StabilityFigures:
    """The checks of a run, one per requirement and object; `table` has the same as rows of `tables.STABILITY`."""

    checks: tuple[Check, ...]
    table: pa.Table

    @property
    def requirements(self) -> dict[str, list[Check]]:
        """The checks of all objects by requirement."""
        names = dict.fromkeys(check.requirement for check in self.checks)
        return {
            name: [check for check in self.checks if check.requirement == name] for name in names
        }

    @property
    def objects(self) -> dict[str, list[Check]]:
        """The checks by object, `class/name`."""
        keys = sorted({check.key for check in self.checks})
        return {key: [check for check in self.checks if check.key == key] for key in keys}

    @property
    def broken(self) -> list[Check]:
        """The checks that exceeded their tolerance."""
        return [check for check in self.checks if not check.held]


class HardCases(NamedTuple):
    """Totals of `make test-hard`: numbers of cases and requirements, and the requirements that were exceeded."""

    cases: int
    requirements: int
    exceeded: Sequence[str]
    version: str
    date: str


def stability_figures(table: pa.Table) -> StabilityFigures:
    """Return the checks in rows of `tables.STABILITY`."""
    return StabilityFigures(tuple(map(_check, table.to_pylist())), table)


def describe_checks(checks: Iterable[Check]) -> str:
    """Return one or two sentences on checks: their number, and those exceeded or else the largest error.

    At least one check is needed.
    """
    checks = list(checks)
    cases = counted(sum(check.cases for check in checks), "hard case")
    kinds = {check.requirement for check in checks}
    tried = f"{cases} of {counted(len(kinds), 'kind')}"
    broken = [check.title for check in checks if not check.held]
    if broken:
        return f"{tried}: {counted(len(broken), 'tolerance')} exceeded ({'; '.join(broken)})."
    worst = max(checks, key=lambda check: check.share)
    exact = len(kinds - {check.requirement for check in checks if check.share > 0})
    return (
        f"{tried} were tried. Every error is within its tolerance; {counted(exact, 'kind')} "
        f"{'has' if exact == 1 else 'have'} no error at all. The largest error is "
        f"{percent(worst.share, 2)} of its tolerance ({worst.title})."
    )


def read_hard_cases(path: Path) -> HardCases:
    """Read the totals that `make test-hard` writes; raises `ReportError` if the file is damaged."""

    def totals(stored: Any) -> HardCases:
        return HardCases(**{name: stored[name] for name in HardCases._fields})

    return read_json(path, totals, "holds no totals of hard cases", "run make test-hard again")


def describe_hard_cases(totals: HardCases) -> str:
    """Return a sentence on the hard cases of the code, and on exceeded tolerances."""
    tried = (
        f"The code itself was tried on {counted(totals.cases, 'hard case')} of "
        f"{counted(totals.requirements, 'kind')} with known results ({totals.date}, version {totals.version})"
    )
    if not totals.exceeded:
        return f"{tried}: every error is within its tolerance."
    return (
        f"{tried}: {counted(len(totals.exceeded), 'tolerance')} exceeded "
        f"({'; '.join(totals.exceeded)})."
    )


def _check(row: Row) -> Check:
    names = set(Check.__dataclass_fields__) - {"key"}
    return Check(key=f"{row['class']}/{row['object']}", **{name: row[name] for name in names})
