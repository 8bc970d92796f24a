"""What a check finds: the errors of its cases, and the worst of them by tolerance."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from visuohaptic.stability.tolerances import Tolerance


@dataclass(frozen=True)
class Finding:
    """The errors of some cases.

    Attributes
    ----------
    tolerance : str
        Its name, `family/requirement`.
    errors : array_like
        Any shape, in the tolerance's unit; True is an error of 1, and NaN is infinite.
    hardest : str or callable
        The case in words; a function takes its place among the flat errors.
    drawing : str or callable
        The same as SVG; may be empty.
    cases : int or None
        How many cases were tried, where one error stands for several.
    """

    tolerance: str
    errors: ArrayLike
    hardest: str | Callable[[int], str] = ""
    drawing: str | Callable[[int], str] = ""
    cases: int | None = None


@dataclass(frozen=True)
class Result:
    """The worst error of all cases that share a tolerance.

    Attributes
    ----------
    name : str
        The tolerance's name, `family/requirement`.
    tolerance : Tolerance
        What is allowed, and why.
    cases : int
        How many were tried.
    worst_error : float
        In the tolerance's unit; may be infinite.
    hardest, drawing : str
        The worst case in words and as SVG.
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
    """Make a check.

    Parameters
    ----------
    check : callable
        Gives what it finds.
    tolerances : mapping of str to Tolerance
        All that it may find, by name.

    Returns
    -------
    list of Result
        One for each finding that has cases. A check that breaks off, for a kernel may fail in any
        way, has an infinite error under each of its tolerances instead.
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
    """Sum up cases and keep the worst error by tolerance.

    Parameters
    ----------
    results : iterable of Result
        In any number for each tolerance; of equal errors the first one is kept.

    Returns
    -------
    dict of str to Result
        One for each tolerance that has cases, in the order in which they come.
    """
    merged: dict[str, Result] = {}
    for result in results:
        kept = merged.get(result.name)
        if kept is None:
            merged[result.name] = result
            continue
        worse = result if result.worst_error > kept.worst_error else kept
        merged[result.name] = replace(worse, cases=kept.cases + result.cases)
    return merged
