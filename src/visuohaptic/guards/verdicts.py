"""What a guard found, the table of it, and the bounds that its false alarms are limited by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from visuohaptic.errors import GuardError
from visuohaptic.tables.guards import GUARDS
from visuohaptic.tables.schema import build_rows, read_table

ALARM = 1e-5
"""Probability of a false alarm of one random test; a run makes at most six."""

Outcome = Literal["held", "failed", "not tested"]


@dataclass(frozen=True)
class Verdict:
    """What one guard found, in one sentence, or why nothing was tested."""

    guard: str
    outcome: Outcome
    found: str


def judge(guard: str, *, held: bool, found: str) -> Verdict:
    """Give the verdict of a guard that was tested."""
    return Verdict(guard, "held" if held else "failed", found)


def table_of(verdicts: Sequence[Verdict]) -> pa.Table:
    """Give verdicts as rows of `tables.GUARDS`."""
    return build_rows(GUARDS, [asdict(verdict) for verdict in verdicts])


def failed_guards(path: str | Path) -> list[str]:
    """Name the guards that failed, in a sentence each."""
    return [
        f"{row['guard']}: failed. {row['found']}"
        for row in read_table(GUARDS, [path]).to_pylist()
        if row["outcome"] == "failed"
    ]


def require_guards(path: str | Path, report: str | Path) -> None:
    """Raise `GuardError` if a guard of the run failed."""
    failed = failed_guards(path)
    if failed:
        raise GuardError(
            f"The run's figures can't be trusted, as {report} says, too: {' '.join(failed)}"
        )


def highest_mean(expected: float, draws: int) -> float:
    """Give the mean of independent values in [0, 1] that chance exceeds with probability `ALARM` at most.

    The bound of W. Hoeffding, J. Am. Stat. Assoc. 58(301), 1963, theorem 1: a mean of n values with
    expectation p reaches a with probability exp(-n KL(a | p)) at most, whatever their distribution.
    The expectation is above 0 and below 1; the mean is 1 where so few values can't exceed chance.
    """
    from scipy.optimize import brentq
    from scipy.special import rel_entr

    def beyond(mean: float) -> float:
        divergence = rel_entr(mean, expected) + rel_entr(1 - mean, 1 - expected)
        return float(draws * divergence + np.log(ALARM))

    return float(brentq(beyond, expected, 1.0)) if beyond(1.0) > 0 else 1.0


def widest_gap(draws: int) -> float:
    """Give how far an empirical distribution exceeds the true one with probability `ALARM` at most.

    The one-sided bound of P. Massart, Ann. Probab. 18(3), 1990.
    """
    return float(np.sqrt(-np.log(ALARM) / (2 * draws)))


def uniform_p_value(values: NDArray[np.float64], bins: int) -> float:
    """Give the p value of the chi-squared test that values, shape (n,), are uniform in [0, 1]."""
    from scipy.stats import chisquare

    places = np.clip(np.floor(values * bins).astype(np.int64), 0, bins - 1)
    return float(chisquare(np.bincount(places, minlength=bins)).pvalue)
