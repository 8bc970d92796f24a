"""The comparison that the experiment is about: fixations against random probing, here and published."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from visuohaptic.evaluation.draws import LeadOverDraws
from visuohaptic.evaluation.intervals import holm
from visuohaptic.evaluation.published import PAPER_PIPELINE, TABLE_1
from visuohaptic.report.estimates import Figure
from visuohaptic.report.wording import (
    classifier_name,
    counted,
    listed,
    percent_points,
    points,
    probability,
    spaced,
    strategy_name,
)
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS

REFERENCE = "fixation"
SIGNIFICANCE = 0.05
PIPELINES: Mapping[str, str] = {
    PAPER_PIPELINE: (
        "Pipeline paper follows the paper: a self-organising map turns the 22 numbers of a "
        "touch into five, and classifiers with their default settings learn from statistics of the "
        "sequence."
    ),
    "order_free": (
        "Pipeline order_free is our own. It has no map, since five numbers keep only a part of a touch. It "
        "describes a sequence by numbers that do not depend on the order of touches: means, spreads, "
        "distances and angles, and an embedding of the poses. The settings of its classifiers are fixed; "
        "they were chosen on 67 objects that are no part of the paper's set. Several views of an object "
        "are classified together by the mean of their log probabilities."
    ),
}
"""What each pipeline is, and why."""

_ORDER = ("fixation", "random")


@dataclass(frozen=True)
class Comparison:
    """Fixations against another strategy, over the same objects; p is adjusted over the table's classifiers.

    Where the other strategy's places were drawn several times, `difference` and the p values are of the mean over
    draws, and `draws` has the lead over each draw; None with a single draw.
    """

    difference: Figure
    p_value: float
    adjusted_p: float
    objects: int
    signs: str
    draws: LeadOverDraws | None = None


@dataclass(frozen=True)
class ClassifierRow:
    """All figures of one classifier; the mappings go by strategy."""

    key: str
    name: str
    accuracy: Mapping[str, Figure]
    object_accuracy: Mapping[str, Figure]
    class_accuracy: Mapping[str, Mapping[str, Figure]]
    published: Mapping[str, float]
    comparisons: Mapping[str, Comparison]
    notes: tuple[str, ...]

    @property
    def published_gain(self) -> float | None:
        """By how much fixations are ahead of random probing in the paper."""
        found = self.published
        return found["fixation"] - found["random"] if found else None


@dataclass(frozen=True)
class PipelineTable:
    """One pipeline's classifiers, as in the paper's table, its strategies, fixations first, and what was tested."""

    name: str
    strategies: tuple[str, ...]
    rows: tuple[ClassifierRow, ...]
    splits: int
    repeats: int
    objects: int
    sequences: int

    @property
    def leading(self) -> str:
        """The strategy that the page speaks of: fixations where they were run."""
        return self.strategies[0]

    @property
    def best(self) -> ClassifierRow:
        """The classifier with the highest accuracy under the leading strategy."""
        return max(self.rows, key=lambda row: row.accuracy[self.leading].mean)

    @property
    def headline(self) -> ClassifierRow:
        """The pipeline's headline classifier; the best classifier if a run lacks it."""
        key = HEADLINE_CLASSIFIERS.get(self.name)
        return next((row for row in self.rows if row.key == key), self.best)


def read_tables(metrics: Mapping[str, Any]) -> list[PipelineTable]:
    """Arrange what `summarise` gives for the page, the paper's pipeline first."""
    names = sorted(metrics["results"], key=pipeline_order)
    compared = metrics["comparisons"]
    return [
        _pipeline_table(metrics["results"][name], compared.get(name, {}), name) for name in names
    ]


def pipeline_order(name: str) -> tuple[bool, str]:
    """Order pipelines by name, the paper's first."""
    return name != PAPER_PIPELINE, name


def merge_notes(notes: Collection[str]) -> tuple[str, ...]:
    """Merge notes that differ in their last number alone, such as ``k 5`` and ``k 15``."""
    merged: dict[str, list[float]] = {}
    for note in notes:
        words, _, last = note.rpartition(" ")
        try:
            number = float(last)
        except ValueError:
            merged[note] = []
        else:
            merged.setdefault(words, []).append(number)
    return tuple(
        spaced(f"{words} {' or '.join(f'{value:g}' for value in sorted(numbers))}".rstrip())
        for words, numbers in sorted(merged.items())
    )


def draws_sentence(table: PipelineTable, strategy: str = "random") -> str:
    """Say over how many draws of random places the headline figures are means, and how far one draw moves the lead.

    Empty with a single draw.
    """
    row = table.headline
    compared = row.comparisons.get(strategy)
    if compared is None or compared.draws is None or compared.draws.count < 2:
        return ""
    found = compared.draws
    return (
        f"Figures of the {row.name} by {strategy_name(strategy)} are means over {found.count} draws of its places; "
        f"its votes of whole objects, and all other classifiers, are of the first draw. Fixations lead by "
        f"{points(min(found.leads))} to {points(max(found.leads))} points over single draws: one draw moves the "
        f"lead by ±{percent_points(found.standard_deviation)} points (standard deviation)."
    )


def gain_sentence(table: PipelineTable) -> str:
    """Say with how many classifiers fixations are ahead of random probing; empty without both."""
    compared = [
        (row.name, row.comparisons["random"]) for row in table.rows if "random" in row.comparisons
    ]
    if not compared:
        return ""
    gains = [found.difference.mean for _, found in compared]
    settled = [
        f"{name} ({points(found.difference.mean)})"
        for name, found in compared
        if found.adjusted_p < SIGNIFICANCE
    ]
    least = probability(min(found.adjusted_p for _, found in compared))
    verdict = (
        f"and the difference is significant for {listed(settled)} (p after Holm's correction below "
        f"{SIGNIFICANCE:g})"
        if settled
        else f"but with {counted(compared[0][1].objects, 'object')} no difference is significant "
        f"(the least p after Holm's correction is {least})"
    )
    return (
        f"Fixations are ahead of random probing with {sum(gain > 0 for gain in gains)} of "
        f"{counted(len(gains), 'classifier')} (leads from {points(min(gains))} to {points(max(gains))} "
        f"points), {verdict}."
    )


def _pipeline_table(
    results: Mapping[str, Any], compared: Mapping[str, Any], name: str
) -> PipelineTable:
    strategies = _sorted(results, _ORDER)
    keys = _sorted({key for cells in results.values() for key in cells}, tuple(TABLE_1))
    pairs = [(key, strategy) for key in sorted(compared) for strategy in sorted(compared[key])]
    found = holm([compared[key][strategy]["p_value"] for key, strategy in pairs])
    adjusted = dict(zip(pairs, found, strict=True))
    cell = next(iter(results[strategies[0]].values()))
    return PipelineTable(
        name,
        tuple(strategies),
        tuple(_row(results, key, name, compared.get(key, {}), adjusted) for key in keys),
        *(cell[count] for count in ("splits", "repeats", "objects", "sequences")),
    )


def _sorted(names: Collection[str], first: Sequence[str]) -> list[str]:
    """Order names: those of `first` as there, then the others by name."""
    return sorted(names, key=lambda one: (first.index(one) if one in first else len(first), one))


def _row(
    results: Mapping[str, Any],
    key: str,
    pipeline: str,
    compared: Mapping[str, Any],
    adjusted: Mapping[tuple[str, str], float],
) -> ClassifierRow:
    cells = {strategy: found[key] for strategy, found in results.items() if key in found}
    accuracy, by_vote = (
        {strategy: Figure(**cell[name]) for strategy, cell in cells.items()}
        for name in ("accuracy", "object_accuracy")
    )
    return ClassifierRow(
        key=key,
        name=classifier_name(key),
        accuracy=accuracy,
        object_accuracy=by_vote,
        class_accuracy={
            strategy: {name: Figure(**figure) for name, figure in cell["class_accuracy"].items()}
            for strategy, cell in cells.items()
        },
        published=TABLE_1.get(key, {}) if pipeline == PAPER_PIPELINE else {},
        comparisons={
            strategy: Comparison(
                Figure(**found["difference"]),
                found["p_value"],
                adjusted[key, strategy],
                found["objects"],
                "all" if found["exact"] else "drawn at random",
                LeadOverDraws(tuple(found["draws"]["leads"])) if "draws" in found else None,
            )
            for strategy, found in compared.items()
        },
        notes=merge_notes({note for cell in cells.values() for note in cell["notes"]}),
    )
