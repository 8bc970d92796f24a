"""The experiment's comparison: fixations against random probing, in this run and as published."""

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
        "they were chosen on 67 objects outside the paper's set. Several views of an object "
        "are classified together by the mean of their log probabilities."
    ),
}
"""Descriptions of the pipelines."""

_ORDER = ("fixation", "random")


@dataclass(frozen=True)
class Comparison:
    """Fixations against another strategy, over the same objects.

    Attributes
    ----------
    difference : Figure
        Accuracy of fixations minus accuracy of the other strategy; over the mean of its draws, if there are several.
    p_value : float
        The p value of the paired comparison.
    adjusted_p : float
        The p value with Holm's correction over the table's classifiers and strategies.
    objects : int
        The number of objects.
    signs : str
        Which sign changes the test took: ``all`` or ``drawn at random``.
    draws : LeadOverDraws, optional
        The lead over each draw of the other strategy's places; None with a single draw.
    """

    difference: Figure
    p_value: float
    adjusted_p: float
    objects: int
    signs: str
    draws: LeadOverDraws | None = None


@dataclass(frozen=True)
class ClassifierRow:
    """All figures of one classifier; the keys of the mappings are strategies."""

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
        """The published accuracy of fixations minus that of random probing; None if the paper has none."""
        published = self.published
        return published["fixation"] - published["random"] if published else None


@dataclass(frozen=True)
class PipelineTable:
    """The figures of one pipeline.

    Attributes
    ----------
    name : str
        The pipeline.
    strategies : tuple of str
        The strategies, fixations first.
    rows : tuple of ClassifierRow
        The classifiers, in the order of the paper's table.
    splits, repeats, objects, sequences : int
        Numbers of splits and repeats, and of tested objects and sequences.
    """

    name: str
    strategies: tuple[str, ...]
    rows: tuple[ClassifierRow, ...]
    splits: int
    repeats: int
    objects: int
    sequences: int

    @property
    def leading(self) -> str:
        """The strategy of the headline figures: fixations if the run has them."""
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
    """Return the result of `evaluation.summary.summarise` as one table per pipeline, the paper's pipeline first."""
    names = sorted(metrics["results"], key=pipeline_order)
    compared = metrics["comparisons"]
    return [
        _pipeline_table(metrics["results"][name], compared.get(name, {}), name) for name in names
    ]


def pipeline_order(name: str) -> tuple[bool, str]:
    """Return a sorting key: the paper's pipeline first, then by name."""
    return name != PAPER_PIPELINE, name


def merge_notes(notes: Collection[str]) -> tuple[str, ...]:
    """Merge notes that differ only in their last number: ``k 5`` and ``k 15`` become ``k 5 or 15``."""
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
    """Return a sentence on the draws of random places behind the headline figures, and on their spread.

    Empty with a single draw.
    """
    row = table.headline
    compared = row.comparisons.get(strategy)
    if compared is None or compared.draws is None or compared.draws.count < 2:
        return ""
    draws = compared.draws
    return (
        f"Figures of the {row.name} by {strategy_name(strategy)} are means over {draws.count} draws of its places. "
        f"Its votes of whole objects, and all other classifiers, use the first draw. Over single draws fixations lead by "
        f"{points(min(draws.leads))} to {points(max(draws.leads))} points (standard deviation "
        f"{percent_points(draws.standard_deviation)} points)."
    )


def gain_sentence(table: PipelineTable) -> str:
    """Return a sentence on the classifiers with which fixations are ahead of random probing.

    Empty if the run lacks one of the two strategies.
    """
    compared = [
        (row.name, row.comparisons["random"]) for row in table.rows if "random" in row.comparisons
    ]
    if not compared:
        return ""
    gains = [comparison.difference.mean for _, comparison in compared]
    significant = [
        f"{name} ({points(comparison.difference.mean)})"
        for name, comparison in compared
        if comparison.adjusted_p < SIGNIFICANCE
    ]
    smallest = probability(min(comparison.adjusted_p for _, comparison in compared))
    verdict = (
        f"and the difference is significant for {listed(significant)} (p after Holm's correction below "
        f"{SIGNIFICANCE:g})"
        if significant
        else f"but with {counted(compared[0][1].objects, 'object')} no difference is significant "
        f"(the smallest p after Holm's correction is {smallest})"
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
    adjusted_values = holm([compared[key][strategy]["p_value"] for key, strategy in pairs])
    adjusted = dict(zip(pairs, adjusted_values, strict=True))
    cell = next(iter(results[strategies[0]].values()))
    return PipelineTable(
        name,
        tuple(strategies),
        tuple(_row(results, key, name, compared.get(key, {}), adjusted) for key in keys),
        *(cell[count] for count in ("splits", "repeats", "objects", "sequences")),
    )


def _sorted(names: Collection[str], first: Sequence[str]) -> list[str]:
    """Return names in the order of `first`; names that are not in `first` follow, sorted."""
    return sorted(
        names, key=lambda name: (first.index(name) if name in first else len(first), name)
    )


def _row(
    results: Mapping[str, Any],
    key: str,
    pipeline: str,
    compared: Mapping[str, Any],
    adjusted: Mapping[tuple[str, str], float],
) -> ClassifierRow:
    cells = {strategy: by_key[key] for strategy, by_key in results.items() if key in by_key}
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
                Figure(**comparison["difference"]),
                comparison["p_value"],
                adjusted[key, strategy],
                comparison["objects"],
                "all" if comparison["exact"] else "drawn at random",
                LeadOverDraws(tuple(comparison["draws"]["leads"]))
                if "draws" in comparison
                else None,
            )
            for strategy, comparison in compared.items()
        },
        notes=merge_notes({note for cell in cells.values() for note in cell["notes"]}),
    )
