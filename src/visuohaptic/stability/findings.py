"""What a check finds: the errors of its cases, and the worst of them by tolerance."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from visuohaptic.stability.tolerances import Tolerance


@dataclass(frozen=True)
class Finding:
    """The errors of some cases, by the tolerance's name, `family/requirement`.

    `errors` have any shape and the tolerance's unit; True is an error of 1, and NaN is infinite.
    `hardest` is the case in words and `drawing` the same as SVG, or empty; a function takes its place
    among the flat errors. `cases` counts those that were tried, where one error stands for several.
    """

    tolerance: str
    errors: ArrayLike
    hardest: str | Callable[[int], str] = ""
    drawing: str | Callable[[int], str] = ""
    cases: int | None = None


@dataclass(frozen=True)
class Result:
    """The worst error of all cases that share a tolerance, with that case in words and as SVG.

    `name` is `family/requirement`; `worst_error` has the tolerance's unit and may be infinite.
    """

    name: str
    tolerance: Tolerance
    cases: int
    worst_error: float
    hardest: str
    drawing: str

    @property
    def held(self) -> bool:
        """Whether the worst error is within the tolerance."""
        return self.worst_error <= self.tolerance.bound


def worst_of(finding: Finding, tolerances: Mapping[str, Tolerance]) -> Result | None:
    """Give the worst case of a finding, beside its tolerance by name; None where there is no case."""
    errors = np.atleast_1d(np.asarray(finding.errors, dtype=np.float64)).ravel()
    if not errors.size:
        return None
    errors = np.where(np.isnan(errors), np.inf, errors)
    place = int(np.argmax(errors))
    hardest, drawing = (
        made(place) if callable(made) else made for made in (finding.hardest, finding.drawing)
    )
    cases = errors.size if finding.cases is None else finding.cases
    allowed = tolerances[finding.tolerance]
    return Result(finding.tolerance, allowed, cases, float(errors[place]), hardest, drawing)


def measure(
    check: Callable[[], Iterable[Finding]], tolerances: Mapping[str, Tolerance]
) -> list[Result]:
    """Make a check, and give a result for each finding that has cases.

    `tolerances` are all that it may find, by name. A check that breaks off, for a kernel may fail in
    any way, has an infinite error under each of them instead.
    """
    try:
        found = [worst_of(finding, tolerances) for finding in check()]
        return [result for result in found if result is not None]
    except Exception as error:  # noqa: BLE001 - the failure is the finding, and the table names it
        sentence = f"ended in {type(error).__name__}: {error}"
        return [
            Result(name, tolerance, 1, float("inf"), sentence, "")
            for name, tolerance in tolerances.items()
        ]


def merge_results(results: Iterable[Result]) -> dict[str, Result]:
    """Sum up cases and keep the worst error by tolerance, in the order in which they come; the first of equal ones."""
    merged: dict[str, Result] = {}
    for result in results:
        kept = merged.get(result.name)
        if kept is None:
            merged[result.name] = result
            continue
        worse = result if result.worst_error > kept.worst_error else kept
        merged[result.name] = replace(worse, cases=kept.cases + result.cases)
    return merged
