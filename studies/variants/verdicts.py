"""What measured differences say of a claim: the rule, written down before the tables that it judges.

A claim says that one way is better than another, such as touches by fixation than random ones. Its
evidence is a paired difference in each variant and set of objects. The first that holds:

- **yes**: in the default and in the most literal variant, on the paper's set and on the objects
  outside it, the interval of the difference lies above 0.
- **no**: in the same four, the interval excludes a gain of `GAIN`.
- **depends**: two of the four differ significantly from 0 in opposite directions, or on one set at
  least `OPPOSED` of all variants are significantly ahead and as many significantly behind, twice what
  chance gives on each side.
- **not shown**: anything else, also where one of the four was not measured.

A difference is significant if its two-sided p value is below `leads.SIGNIFICANT`; p values are not
adjusted, as each is that of one variant by itself.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal

from variants.choices import BY_NAME
from variants.design import is_default, is_literal
from variants.leads import MAIN_OPPONENT, SIGNIFICANT
from visuohaptic.report.questions import GAIN
from visuohaptic.report.variants import Verdict
from visuohaptic.studies.figures import Row

Kind = Literal["default", "literal", "other"]

SETS = ("paper", "outside")
"""The paper's objects, and those of the catalogue that are not the paper's."""

OPPOSED = 0.05
"""Share of variants on either side at which variants count as opposed."""


@dataclass(frozen=True)
class Evidence:
    """A paired difference in one variant on one of `SETS`, with its interval: by how much the claimed way is better, as a share."""

    objects: str
    variant: Kind
    difference: float
    low: float
    high: float
    p_value: float

    @property
    def side(self) -> int:
        """1 where the claimed way is significantly better, -1 where significantly worse, else 0."""
        if self.p_value >= SIGNIFICANT:
            return 0
        return (self.difference > 0) - (self.difference < 0)


def verdict(evidence: Iterable[Evidence]) -> Verdict:
    """Judge a claim by the rule above.

    Of the evidence at most one is of each set for the default and for the literal variant; there
    may be any others.
    """
    found = list(evidence)
    main = [one for one in found if one.variant != "other"]
    measured = {(one.objects, one.variant) for one in main}
    if measured == set(product(SETS, ("default", "literal"))):
        if all(one.low > 0 for one in main):
            return "yes"
        if all(one.high < GAIN for one in main):
            return "no"
    opposed = {1, -1} <= {one.side for one in main}
    return "depends" if opposed or any(_are_opposed(found, name) for name in SETS) else "not shown"


def lead_evidence(
    tables: Mapping[str, Sequence[Row]], classifier: str, opponent: str = MAIN_OPPONENT
) -> list[Evidence]:
    """Give the evidence for touches by fixation against one kind of random touches, an option of choice ``random_probing``.

    `tables` has rows of `VARIANTS` by set. Only those that `of_papers_question` takes count.
    """
    return [
        Evidence(
            name, _kind(row), *(row[one] for one in ("ahead", "ahead_low", "ahead_high", "p_value"))
        )
        for name, rows in tables.items()
        for row in of_papers_question(rows, classifier, opponent)
    ]


def of_papers_question(
    rows: Sequence[Row], classifier: str, opponent: str = MAIN_OPPONENT
) -> list[Row]:
    """Take the variants of a classifier and an opponent that were run and ask the paper's question.

    Part ``protocol`` and a shuffled order of touches ask another one.
    """
    return [
        row
        for row in rows
        if (row["classifier"], row["random_probing"]) == (classifier, opponent)
        and row["ahead"] is not None
        and row["part"] != "protocol"
        and row["order"] == BY_NAME["order"].base
    ]


def _kind(row: Row) -> Kind:
    """Say which variant a row is of, whatever the random touches."""
    options = dict(row)
    if is_default(options | {"random_probing": BY_NAME["random_probing"].default}):
        return "default"
    return "literal" if is_literal(options | {"random_probing": "walk"}) else "other"


def _are_opposed(evidence: Sequence[Evidence], objects: str) -> bool:
    sides = [one.side for one in evidence if one.objects == objects]
    return bool(sides) and min(sides.count(1), sides.count(-1)) >= OPPOSED * len(sides)
