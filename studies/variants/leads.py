"""Compute how far fixation is ahead of random probing under each option of each choice."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from statistics import median

import numpy as np

from variants.choices import BY_NAME, CHOICES, Choice
from variants.design import CROSSED, CROSSED_SINGLY, FACTORIAL, is_base_but_for
from visuohaptic.evaluation.intervals import SIGNIFICANCE, holm
from visuohaptic.studies.figures import Row

SAME = 1e-12
"""Leads below this are rounding."""

MAIN_OPPONENT = BY_NAME["random_probing"].base
"""Main kind of random touches: an option of choice ``random_probing``."""


@dataclass(frozen=True)
class Lead:
    """Leads of fixation over random probing in some cases; a case is a variant with one classifier.

    Attributes
    ----------
    cases : int
        Number of cases.
    ahead, behind : int
        Cases in which fixation is ahead of or behind random probing.
    ahead_singly, behind_singly : int
        Cases with p value below `SIGNIFICANCE`, each case tested by itself.
    middle : float
        Median lead, as a share.
    """

    cases: int
    ahead: int
    behind: int
    ahead_singly: int
    behind_singly: int
    middle: float


def against_main(rows: Sequence[Row]) -> list[Row]:
    """Return the rows in which fixation is compared with the main kind of random touches."""
    return [row for row in rows if row["random_probing"] == MAIN_OPPONENT]


def leads_by_option(rows: Sequence[Row]) -> dict[tuple[str, str], Lead]:
    """Compute the leads over the main kind of random touches by choice and option, from rows of `VARIANTS`.

    A recognition choice is judged on the part ``recognition``. The kind of random touches is judged on all variants.
    Any other choice is judged on the part that varies it and on the base of the design. The part ``protocol``, and
    choices with fewer than two options in the table, are left out.
    """
    compared = [row for row in rows if row["ahead"] is not None and row["part"] != "protocol"]
    run = against_main(compared)
    leads: dict[tuple[str, str], Lead] = {}
    for choice in CHOICES:
        judged = compared if choice.where == "opponent" else run
        by_option = {
            option: sum_up(of_option)
            for option, of_option in _by_option(choice, judged)
            if of_option
        }
        if len(by_option) > 1:
            leads |= {(choice.name, option): lead for option, lead in by_option.items()}
    return leads


def sum_up(rows: Sequence[Row]) -> Lead:
    """Compute the lead over rows of `VARIANTS`, at least one; column ``ahead`` of each row must hold a number."""
    leads = [row["ahead"] for row in rows]
    significant = [row["ahead"] for row in rows if (row["p_value"] or 1.0) < SIGNIFICANCE]
    return Lead(
        cases=len(leads),
        ahead=sum(lead > SAME for lead in leads),
        behind=sum(lead < -SAME for lead in leads),
        ahead_singly=sum(lead > SAME for lead in significant),
        behind_singly=sum(lead < -SAME for lead in significant),
        middle=median(leads),
    )


def count_after_holm(rows: Sequence[Row]) -> tuple[int, int]:
    """Count the rows of `VARIANTS` with fixation ahead and behind, p below `SIGNIFICANCE` after Holm's correction.

    The correction is for the number of `rows`. Column ``ahead`` of each row must hold a number.
    """
    leads = [row["ahead"] for row, stands in zip(rows, after_holm(rows), strict=True) if stands]
    return sum(lead > SAME for lead in leads), sum(lead < -SAME for lead in leads)


def after_holm(rows: Sequence[Row]) -> list[bool]:
    """Return whether the lead of each row of `VARIANTS` has p below `SIGNIFICANCE` after Holm's correction for all `rows`."""
    return [p < SIGNIFICANCE for p in holm([row["p_value"] or 1.0 for row in rows])]


def _by_option(choice: Choice, rows: Sequence[Row]) -> Iterator[tuple[str, list[Row]]]:
    is_crossed = len({row[choice.name] for row in rows if row["part"] == "upstream"}) > 1
    if choice.where == "opponent":
        judged = list(rows)
    elif choice.name in FACTORIAL:
        judged = [row for row in rows if row["part"] == "recognition"]
    else:
        # All options are compared over the same options of the crossed choices.
        crossed = CROSSED if choice.name == "map_training" else CROSSED_SINGLY
        judged = [
            row
            for row in rows
            if (
                is_crossed
                if row["part"] == "upstream"
                else is_base_but_for(row, (choice.name, *crossed))
            )
        ]
    for option in choice.options:
        yield option, [row for row in judged if row[choice.name] == option]


@dataclass(frozen=True)
class PairLead:
    """The two recognition choices that explain most of how leads differ, and the leads by pair of options.

    `share` is the share of the sum of squares of the leads that lies between the means of the pairs of options.
    """

    choices: tuple[str, str]
    share: float
    leads: Mapping[tuple[str, str], Lead]


def strongest_pair(rows: Sequence[Row]) -> PairLead | None:
    """Return the pair of recognition choices on which the lead depends most; None if leads do not differ."""
    run = [row for row in rows if row["ahead"] is not None and row["part"] == "recognition"]
    run = against_main(run)
    leads = np.array([row["ahead"] for row in run])
    if not run or np.ptp(leads) < SAME:
        return None
    total = float(np.square(leads - leads.mean()).sum())

    def share(pair: tuple[str, str]) -> float:
        groups = _grouped(run, pair).values()
        means = [(len(group), np.mean([row["ahead"] for row in group])) for group in groups]
        return float(sum(count * (mean - leads.mean()) ** 2 for count, mean in means)) / total

    pair = max(combinations(FACTORIAL, 2), key=share)
    by_options = {options: sum_up(group) for options, group in _grouped(run, pair).items()}
    return PairLead(pair, share(pair), by_options)


def _grouped(rows: Sequence[Row], pair: tuple[str, str]) -> dict[tuple[str, str], list[Row]]:
    groups: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        groups.setdefault((row[pair[0]], row[pair[1]]), []).append(row)
    return groups
