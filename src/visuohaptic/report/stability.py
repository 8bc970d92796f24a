"""How exact numbers are: on the run's objects, and in the hard cases of the code."""

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
        """The worst error over its tolerance; where 0 is allowed, 0 or infinite."""
        if self.worst_error == 0:
            return 0.0
        if self.worst_error is None or self.tolerance == 0:
            return float("inf")
        return self.worst_error / self.tolerance

    @property
    def title(self) -> str:
        """Its object and its requirement."""
        return f"{self.key}: {self.requirement}"


@dataclass(frozen=True)
class StabilityFigures:
    """Checks, one per requirement and object; `table` has them as rows."""

    checks: tuple[Check, ...]
    table: pa.Table

    @property
    def requirements(self) -> dict[str, list[Check]]:
        """The checks of all objects by requirement."""
        names = dict.fromkeys(check.requirement for check in self.checks)
        return {name: [one for one in self.checks if one.requirement == name] for name in names}

    @property
    def objects(self) -> dict[str, list[Check]]:
        """The checks by object, `class/name`."""
        keys = sorted({check.key for check in self.checks})
        return {key: [check for check in self.checks if check.key == key] for key in keys}

    @property
    def broken(self) -> list[Check]:
        """Checks whose tolerance was exceeded."""
        return [check for check in self.checks if not check.held]


class HardCases(NamedTuple):
    """What `make test-hard` found: numbers of cases and requirements, and the requirements that were exceeded."""

    cases: int
    requirements: int
    exceeded: Sequence[str]
    version: str
    date: str


def stability_figures(table: pa.Table) -> StabilityFigures:
    """Return the figures of rows of `tables.STABILITY`."""
    return StabilityFigures(tuple(map(_check, table.to_pylist())), table)


def describe_checks(checks: Iterable[Check]) -> str:
    """Say in a sentence or two how many cases were tried, and which came nearest to its tolerance."""
    found = list(checks)
    cases = counted(sum(check.cases for check in found), "hard case")
    kinds = {check.requirement for check in found}
    tried = f"{cases} of {counted(len(kinds), 'kind')}"
    broken = [check.title for check in found if not check.held]
    if broken:
        return f"{tried}: {counted(len(broken), 'tolerance')} exceeded ({'; '.join(broken)})."
    worst = max(found, key=lambda check: check.share)
    exact = len(kinds - {check.requirement for check in found if check.share > 0})
    return (
        f"{tried} were tried, and every error is within its tolerance; {counted(exact, 'kind')} "
        f"{'has' if exact == 1 else 'have'} no error at all. The largest error, as a share of what "
        f"is allowed, is {percent(worst.share, 2)} ({worst.title})."
    )


def stability_answer(figures: StabilityFigures) -> str:
    """Say how many cases were tried on the run's objects, and what was exceeded."""
    if figures.broken:
        return describe_checks(figures.checks)
    cases = counted(sum(check.cases for check in figures.checks), "case")
    return f"{cases} that are hard for arithmetic, such as flat or tiny shapes; every error is within its tolerance."


def read_hard_cases(path: Path) -> HardCases:
    """Read the totals of the hard cases of the code, which `make test-hard` writes."""

    def totals(found: Any) -> HardCases:
        return HardCases(**{name: found[name] for name in HardCases._fields})

    return read_json(path, totals, "holds no totals of hard cases", "run make test-hard again")


def describe_hard_cases(found: HardCases) -> str:
    """Say how many hard cases of the code were tried, and what was exceeded."""
    tried = (
        f"The code itself was tried on {counted(found.cases, 'hard case')} of "
        f"{counted(found.requirements, 'kind')} with known answers ({found.date}, version {found.version})"
    )
    if not found.exceeded:
        return f"{tried}: every error is within its tolerance."
    return (
        f"{tried}: {counted(len(found.exceeded), 'tolerance')} exceeded "
        f"({'; '.join(found.exceeded)})."
    )


def _check(row: Row) -> Check:
    names = set(Check.__dataclass_fields__) - {"key"}
    return Check(key=f"{row['class']}/{row['object']}", **{name: row[name] for name in names})
