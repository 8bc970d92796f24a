"""Judge a claim by measured differences; the rule was written down before the tables that it judges.

A claim states that one method is better than another, such as touches by fixation than random touches. The evidence is a
paired difference per variant and set of objects. Four differences count most: those of the default and of the most
literal variant, on the paper's set and on the objects outside of it. The verdict is the first that holds:

- **yes**: all four differences are significantly above 0.
- **depends**: two of the four differ significantly from 0 in opposite directions. Also if on one set at least the share
  `OPPOSED` of all variants is significantly ahead, and at least the same share significantly behind; chance gives half of
  it on each side.
- **not shown**: all other cases, also if one of the four was not measured.

A difference is significant if its two-sided p value is below `SIGNIFICANCE`. P values are not adjusted, because each
of them is about one variant. The rule as it was written first also had a verdict *no*, if four intervals excluded a gain of
two points. No table met it; it is left out, because the tables have no intervals of differences.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal

from variants.choices import BY_NAME
from variants.design import is_default, is_literal
from variants.leads import MAIN_OPPONENT
from visuohaptic.evaluation.intervals import SIGNIFICANCE
from visuohaptic.studies.figures import Row

Kind = Literal["default", "literal", "other"]
Verdict = Literal["yes", "depends", "not shown"]

SETS = ("paper", "outside")
"""Objects of the paper, and objects of the catalogue that are not in the paper."""

OPPOSED = 0.05
"""Least share of variants on each side for which the verdict is ``depends``."""


@dataclass(frozen=True)
class Evidence:
    """Paired difference of accuracy, claimed method minus the other, of a variant on one of `SETS`."""

    objects: str
    variant: Kind
    difference: float
    p_value: float

    @property
    def side(self) -> int:
        """1 if the claimed method is significantly better, -1 if significantly worse, else 0."""
        if self.p_value >= SIGNIFICANCE:
            return 0
        return (self.difference > 0) - (self.difference < 0)


def verdict(evidence: Iterable[Evidence]) -> Verdict:
    """Return the verdict on a claim by the rule of this module.

    `evidence` has at most one entry per set for the default and for the literal variant, and any number of entries for
    other variants.
    """
    entries = list(evidence)
    main = [entry for entry in entries if entry.variant != "other"]
    measured = {(entry.objects, entry.variant) for entry in main}
    if measured == set(product(SETS, ("default", "literal"))) and all(
        entry.side == 1 for entry in main
    ):
        return "yes"
    opposed = {1, -1} <= {entry.side for entry in main}
    if opposed or any(_are_opposed(entries, name) for name in SETS):
        return "depends"
    return "not shown"


def lead_evidence(
    tables: Mapping[str, Sequence[Row]], classifier: str, opponent: str = MAIN_OPPONENT
) -> list[Evidence]:
    """Return the evidence for touches by fixation against one kind of random touches.

    `tables` has rows of `VARIANTS` by set. `opponent` is an option of choice ``random_probing``. Only rows of
    `of_papers_question` count.
    """
    return [
        Evidence(name, _kind(row), row["ahead"], row["p_value"])
        for name, rows in tables.items()
        for row in of_papers_question(rows, classifier, opponent)
    ]


def of_papers_question(
    rows: Sequence[Row], classifier: str, opponent: str = MAIN_OPPONENT
) -> list[Row]:
    """Return the rows of a classifier and an opponent that have a lead and ask the paper's question.

    Part ``protocol`` and a shuffled order of touches ask other questions.
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
    """Return the kind of a row's variant, for any kind of random touches."""
    options = dict(row)
    if is_default(options | {"random_probing": BY_NAME["random_probing"].default}):
        return "default"
    return "literal" if is_literal(options | {"random_probing": "walk"}) else "other"


def _are_opposed(evidence: Sequence[Evidence], objects: str) -> bool:
    sides = [entry.side for entry in evidence if entry.objects == objects]
    return bool(sides) and min(sides.count(1), sides.count(-1)) >= OPPOSED * len(sides)
