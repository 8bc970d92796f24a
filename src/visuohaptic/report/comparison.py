"""The experiment's comparison: fixations against random probing, in this run and as published."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from visuohaptic.evaluation.intervals import SIGNIFICANCE, holm
from visuohaptic.evaluation.means_over_draws import LeadOverDraws
from visuohaptic.evaluation.published import PAPER_PIPELINE, TABLE_1
from visuohaptic.report.estimates import Estimate, measured
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
"""The strategy that all other strategies are compared with."""
PIPELINES: Mapping[str, str] = {
    PAPER_PIPELINE: (
        "Pipeline paper is our variant of the paper, which a written rule chose: a self-organising map turns the 22 "
        "numbers of a touch into five (by default the means of five groups of the numbers), and classifiers with their "
        "default settings learn from statistics of the sequence."
    ),
    "order_free": (
        "Pipeline order_free is our own. It has no map, since five numbers keep only a part of a touch. It "
        "describes a sequence by numbers that do not depend on the order of touches: statistics over touches such as "
        "means and standard deviations, distances and angles between touches, and a kernel mean embedding of the "
        "poses. The settings of its classifiers are fixed. "
        "They were chosen on 67 objects outside the paper's set. Several views of an object "
        "are classified together by the mean of their log probabilities."
    ),
    "learned": (
        "Pipeline learned has a network that learns the class of single touches, or of pairs of touches where little "
        "of the pose is known. A sequence has the mean of their log probabilities, plus a weight times those of the "
        "linear discriminant of order_free. Its settings were chosen on 67 objects outside the paper's set."
    ),
}
"""Descriptions of the pipelines for the page, by name."""

_ORDER = ("fixation", "random")


@dataclass(frozen=True)
class Comparison:
    """Paired comparison of fixations with another strategy, over the objects that both strategies tested.

    Attributes
    ----------
    difference : Estimate
        Accuracy of fixations minus accuracy of the other strategy, as a share. A random strategy with several draws of
        its places has each object's mean accuracy over draws.
    p_value : float
        The two-sided p value of new objects of the same classes.
    adjusted_p : float
        `p_value` after Holm's correction for all classifiers and strategies of the pipeline.
    objects : int
        The number of objects that both strategies tested.
    draws : LeadOverDraws, optional
        The lead of fixations over each draw of a random strategy; None if fewer than two draws were measured.
    """

    difference: Estimate
    p_value: float
    adjusted_p: float
    objects: int
    draws: LeadOverDraws | None = None


@dataclass(frozen=True)
class ClassifierRow:
    """All figures of one classifier, by strategy; accuracies are shares from 0 to 1.

    Attributes
    ----------
    key, name : str
        The classifier's key in ``reports/metrics.json``, and its name in words.
    accuracy : mapping of str to Estimate
        Share of test sequences correctly classified, the mean over splits.
    class_accuracy : mapping of str to mapping of str to Estimate
        Mean accuracy of each class's objects, by strategy and class.
    published : mapping of str to float
        The paper's accuracies; empty for other pipelines than the paper's, and for classifiers that the paper lacks.
    comparisons : mapping of str to Comparison
        Fixations against each other strategy.
    notes : tuple of str
        Notes from training, such as chosen settings, and draws that failed; merged over strategies by `merge_notes`.
    """

    key: str
    name: str
    accuracy: Mapping[str, Estimate]
    class_accuracy: Mapping[str, Mapping[str, Estimate]]
    published: Mapping[str, float]
    comparisons: Mapping[str, Comparison]
    notes: tuple[str, ...]


@dataclass(frozen=True)
class PipelineTable:
    """The figures of one pipeline.

    Attributes
    ----------
    name : str
        The pipeline's key, such as ``paper``.
    strategies : tuple of str
        The strategies: fixations, random probing, then all others, sorted.
    rows : tuple of ClassifierRow
        The classifiers in the order of the paper's table, then all others, sorted.
    splits, repeats : int
        The number of splits, and of repeats of the recognition with different random seeds.
    objects, sequences : int
        The number of distinct tested objects and sequences.
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
        """The strategy of the headline figures: fixations, or else the first of `strategies`."""
        return self.strategies[0]

    @property
    def best(self) -> ClassifierRow:
        """The classifier with the highest accuracy under the leading strategy."""
        return max(self.rows, key=lambda row: row.accuracy[self.leading].mean)

    @property
    def headline(self) -> ClassifierRow:
        """The classifier that `HEADLINE_CLASSIFIERS` names for the pipeline; `best` if the run lacks it."""
        key = HEADLINE_CLASSIFIERS.get(self.name)
        return next((row for row in self.rows if row.key == key), self.best)


def pipeline_tables(metrics: Mapping[str, Any]) -> list[PipelineTable]:
    """Arrange metrics as one table per pipeline, the paper's pipeline first.

    `metrics` is the result of `evaluation.summary.summarise`, or the content of ``reports/metrics.json``.
    """
    names = sorted(metrics["results"], key=pipeline_order)
    compared = metrics["comparisons"]
    return [
        _pipeline_table(metrics["results"][name], compared.get(name, {}), name) for name in names
    ]


def without_published(table: PipelineTable) -> PipelineTable:
    """Return a pipeline's table without published accuracies, which are for the paper's objects only."""
    return replace(table, rows=tuple(replace(row, published={}) for row in table.rows))


def pipeline_order(name: str) -> tuple[bool, str]:
    """Return a sorting key: the paper's pipeline first, then by name."""
    return name != PAPER_PIPELINE, name


def merge_notes(notes: Collection[str]) -> tuple[str, ...]:
    """Merge notes that differ only in a number at the end: ``k 5`` and ``k 15`` become ``k 5 or 15``.

    The result is sorted; underscores become spaces.
    """
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
    """Return sentences on the draws of a random strategy's places, and on the lead of fixations over each draw.

    The figures are of the headline classifier. Empty if fewer than two draws were measured.
    """
    row = table.headline
    compared = row.comparisons.get(strategy)
    if compared is None or compared.draws is None:
        return ""
    draws = compared.draws
    return (
        f"The accuracies of the {row.name} by {strategy_name(strategy)} are means over {draws.count} draws of the "
        f"touched places. Accuracies by vote, and all accuracies of other classifiers, are of the first draw. The lead "
        f"of fixations over each single draw is between {points(min(draws.leads))} and {points(max(draws.leads))} "
        f"points (standard deviation {percent_points(draws.standard_deviation)} points)."
    )


def gain_sentence(table: PipelineTable) -> str:
    """Return a sentence on the leads of fixations over random probing, for all classifiers of a pipeline.

    It has the number of positive leads, the smallest and the largest lead, and the significant differences of either
    sign. Empty if no classifier has both strategies.
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
        f"{counted(len(gains), 'classifier')} and behind with {sum(gain < 0 for gain in gains)} (leads from {points(min(gains))} to {points(max(gains))} "
        f"points), {verdict}."
    )


def _pipeline_table(
    results: Mapping[str, Any], compared: Mapping[str, Any], name: str
) -> PipelineTable:
    """Arrange `results[strategy][classifier]` and `compared[classifier][strategy]` of pipeline `name`."""
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
    """Return the row of classifier `key`; `adjusted` has p values by classifier and strategy."""
    cells = {strategy: by_key[key] for strategy, by_key in results.items() if key in by_key}
    return ClassifierRow(
        key=key,
        name=classifier_name(key),
        accuracy={strategy: measured(cell, "accuracy") for strategy, cell in cells.items()},
        class_accuracy={
            strategy: {name: Estimate(**figure) for name, figure in cell["class_accuracy"].items()}
            for strategy, cell in cells.items()
        },
        published=TABLE_1.get(key, {}) if pipeline == PAPER_PIPELINE else {},
        comparisons={
            strategy: Comparison(
                measured(comparison, "difference"),
                comparison["p_value"],
                adjusted[key, strategy],
                comparison["objects"],
                _lead_over_draws(comparison),
            )
            for strategy, comparison in compared.items()
        },
        notes=merge_notes({note for cell in cells.values() for note in cell["notes"]}),
    )


def _lead_over_draws(comparison: Mapping[str, Any]) -> LeadOverDraws | None:
    """Return the leads over two or more draws; None for a single draw, also if all further draws failed."""
    leads = comparison.get("draws", {}).get("leads", ())
    return LeadOverDraws(tuple(leads)) if len(leads) > 1 else None
