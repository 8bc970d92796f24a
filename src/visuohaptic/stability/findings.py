"""Errors of the cases of a check, and the worst error per tolerance."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from visuohaptic.stability.tolerances import Tolerance


@dataclass(frozen=True)
class Finding:
    """Errors of some cases that share a tolerance.

    Attributes
    ----------
    tolerance : str
        The name of the tolerance.
    errors : array_like, any shape
        One error per case, in the tolerance's unit. True counts as 1, NaN as infinite.
    hardest : str or callable
        The worst case in words, or a function that returns these words for its index in the flat errors.
    """

    tolerance: str
    errors: ArrayLike
    hardest: str | Callable[[int], str] = ""


@dataclass(frozen=True)
class Result:
    """The worst error of all cases that share a tolerance.

    Attributes
    ----------
    name : str
        The name of the tolerance.
    tolerance : Tolerance
        The bound, its unit and its reason.
    cases : int
        The number of cases.
    worst_error : float
        The worst error in the tolerance's unit; may be infinite.
    hardest : str
        The case with the worst error, in words.
    """

    name: str
    tolerance: Tolerance
    cases: int
    worst_error: float
    hardest: str

    @property
    def held(self) -> bool:
        """Whether the worst error is within the tolerance."""
        return self.worst_error <= self.tolerance.bound


def results_of(
    findings: Iterable[Finding], tolerances: Mapping[str, Tolerance]
) -> Iterator[Result]:
    """Yield the worst case of each finding; findings without cases are left out.

    `tolerances` maps names to tolerances and needs the name of every finding that has cases.
    """
    for finding in findings:
        errors = np.asarray(finding.errors, dtype=np.float64).ravel()
        if not errors.size:
            continue
        errors = np.where(np.isnan(errors), np.inf, errors)
        worst = int(np.argmax(errors))
        hardest = finding.hardest(worst) if callable(finding.hardest) else finding.hardest
        tolerance = tolerances[finding.tolerance]
        yield Result(finding.tolerance, tolerance, errors.size, float(errors[worst]), hardest)


def measure(
    check: Callable[[], Iterable[Finding]], tolerances: Mapping[str, Tolerance]
) -> list[Result]:
    """Run a check and return one result per finding.

    `tolerances` are all tolerances that the check may name. If the check raises an error, every tolerance
    has one case with an infinite error.
    """
    try:
        return list(results_of(check(), tolerances))
    except Exception as error:  # noqa: BLE001 - the failure is the finding, and the table names it
        sentence = f"ended in {type(error).__name__}: {error}"
        return [
            Result(name, tolerance, 1, float("inf"), sentence)
            for name, tolerance in tolerances.items()
        ]


def merge_results(results: Iterable[Result]) -> dict[str, Result]:
    """Merge results by tolerance: cases are summed, and the worst error is kept, the first of equal errors."""
    merged: dict[str, Result] = {}
    for result in results:
        kept = merged.setdefault(result.name, result)
        if kept is not result:
            worse = result if result.worst_error > kept.worst_error else kept
            merged[result.name] = replace(worse, cases=kept.cases + result.cases)
    return merged
