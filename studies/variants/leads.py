"""How far fixation is ahead of random probing under each option of each choice."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from statistics import median

import numpy as np

from variants.choices import BY_NAME, CHOICES, Choice
from variants.design import CROSSED, CROSSED_SINGLY, FACTORIAL, is_base_but_for
from visuohaptic.studies.figures import Row

SIGNIFICANT = 0.05
SAME = 1e-12
"""Leads below it are rounding."""

MAIN_OPPONENT = BY_NAME["random_probing"].base
"""The main kind of random touches, an option."""


@dataclass(frozen=True)
class Lead:
    """Variants with one option; a case is a variant with one classifier.

    Fixation is ahead of or behind random probing in so many cases; `middle` is its median lead over
    the cases, as a share.
    """

    cases: int
    ahead: int
    behind: int
    ahead_significantly: int
    behind_significantly: int
    middle: float


def against_main(rows: Sequence[Row]) -> list[Row]:
    """Take the rows in which fixation is compared with the main kind of random touches."""
    return [row for row in rows if row["random_probing"] == MAIN_OPPONENT]


def leads_by_option(rows: Sequence[Row]) -> dict[tuple[str, str], Lead]:
    """Sum up the leads over the main kind of random touches by choice and option, for rows of `VARIANTS`.

    A recognition choice is judged on the part ``recognition``; any other on the part that varies it,
    beside the base of the design; the kind of random touches on all variants. What asks another
    question, and choices without two options in the table, are left out.
    """
    compared = [row for row in rows if row["ahead"] is not None and row["part"] != "protocol"]
    run = against_main(compared)
    found: dict[tuple[str, str], Lead] = {}
    for choice in CHOICES:
        judged = compared if choice.where == "opponent" else run
        leads = {option: sum_up(list(part)) for option, part in _by_option(choice, judged) if part}
        if len(leads) > 1:
            found |= {(choice.name, option): lead for option, lead in leads.items()}
    return found


def sum_up(rows: Sequence[Row]) -> Lead:
    """Sum up the leads of some cases, at least one, all with a lead."""
    leads = [row["ahead"] for row in rows]
    surely = [row["ahead"] for row in rows if (row["p_value"] or 1.0) < SIGNIFICANT]
    return Lead(
        cases=len(leads),
        ahead=sum(lead > SAME for lead in leads),
        behind=sum(lead < -SAME for lead in leads),
        ahead_significantly=sum(lead > SAME for lead in surely),
        behind_significantly=sum(lead < -SAME for lead in surely),
        middle=median(leads),
    )


def _by_option(choice: Choice, rows: Sequence[Row]) -> Iterator[tuple[str, list[Row]]]:
    is_crossed = len({row[choice.name] for row in rows if row["part"] == "upstream"}) > 1
    if choice.where == "opponent":
        part = list(rows)
    elif choice.name in FACTORIAL:
        part = [row for row in rows if row["part"] == "recognition"]
    else:
        # Options are compared over the same other choices.
        others = CROSSED if choice.name == "map_training" else CROSSED_SINGLY
        part = [
            row
            for row in rows
            if (
                is_crossed
                if row["part"] == "upstream"
                else is_base_but_for(row, (choice.name, *others))
            )
        ]
    for option in choice.options:
        yield option, [row for row in part if row[choice.name] == option]


@dataclass(frozen=True)
class PairLead:
    """The two recognition choices that explain most of how leads differ, and the leads by their options.

    `share` is that of the leads' spread between the means of their combinations.
    """

    choices: tuple[str, str]
    share: float
    leads: Mapping[tuple[str, str], Lead]


def strongest_pair(rows: Sequence[Row]) -> PairLead | None:
    """Find the pair of recognition choices on which the lead depends most; None without variants."""
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
    found = {options: sum_up(group) for options, group in _grouped(run, pair).items()}
    return PairLead(pair, share(pair), found)


def _grouped(rows: Sequence[Row], pair: tuple[str, str]) -> dict[tuple[str, str], list[Row]]:
    groups: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        groups.setdefault((row[pair[0]], row[pair[1]]), []).append(row)
    return groups
