"""What a check finds: the errors of its cases, and the worst of them by tolerance."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from visuohaptic.stability.tolerances import Tolerance


@dataclass(frozen=True)
class Finding:
    """The error of each of some cases, by the tolerance's name.

    `errors` have any shape and the tolerance's unit; True is an error of 1, and NaN is infinite.
    `hardest` is the case in words, or a function that returns these words for an index of the flat errors.
    """

    tolerance: str
    errors: ArrayLike
    hardest: str | Callable[[int], str] = ""


@dataclass(frozen=True)
class Result:
    """The worst error of all cases that share a tolerance, with that case in words.

    `name` is the tolerance's; `worst_error` has the tolerance's unit and may be infinite.
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
    """Give the worst case of each finding that has cases, beside its tolerance by name."""
    for finding in findings:
        errors = np.asarray(finding.errors, dtype=np.float64).ravel()
        if not errors.size:
            continue
        errors = np.where(np.isnan(errors), np.inf, errors)
        place = int(np.argmax(errors))
        hardest = finding.hardest(place) if callable(finding.hardest) else finding.hardest
        allowed = tolerances[finding.tolerance]
        yield Result(finding.tolerance, allowed, errors.size, float(errors[place]), hardest)


def measure(
    check: Callable[[], Iterable[Finding]], tolerances: Mapping[str, Tolerance]
) -> list[Result]:
    """Make a check that may find the tolerances named; one that breaks off has an infinite error under each."""
    try:
        return list(results_of(check(), tolerances))
    except Exception as error:  # noqa: BLE001 - the failure is the finding, and the table names it
        sentence = f"ended in {type(error).__name__}: {error}"
        return [
            Result(name, tolerance, 1, float("inf"), sentence)
            for name, tolerance in tolerances.items()
        ]


def merge_results(results: Iterable[Result]) -> dict[str, Result]:
    """Sum up cases and keep the worst error by tolerance, the first of equal ones."""
    merged: dict[str, Result] = {}
    for result in results:
        kept = merged.setdefault(result.name, result)
        if kept is not result:
            worse = result if result.worst_error > kept.worst_error else kept
            merged[result.name] = replace(worse, cases=kept.cases + result.cases)
    return merged
