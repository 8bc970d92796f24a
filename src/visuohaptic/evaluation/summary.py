"""Headline figures from scores and predictions, each with its interval."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.base.errors import RecognitionError
from visuohaptic.evaluation.by_object import ObjectAccuracies
from visuohaptic.evaluation.intervals import (
    balanced_class_interval,
    balanced_interval,
    class_interval,
    compare_paired,
    object_interval,
    plain_comparison,
    plain_interval,
)
from visuohaptic.evaluation.leads import DrawnAccuracies, compare_by_lead
from visuohaptic.evaluation.means_over_draws import (
    FurtherDraws,
    PredictionKey,
    further_draws,
    in_common,
    lead_over_draws,
    mean_over_draws,
    plain_lead,
)
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.recognition.voting import vote_credit
from visuohaptic.tables.phases import owners_of

REFERENCE_STRATEGY = "fixation"

_CELL = list(PredictionKey._fields)

METHOD = {
    "accuracy": "mean over splits of the share of test sequences correctly classified",
    "object_accuracy": "mean over splits of the share of test objects correctly classified by a "
    "vote of their sequences: by the mean of log probabilities where the pipeline gives probabilities, else by "
    "majority, a tie between k classes counting 1/k",
    "balanced_accuracy": "mean over classes of the mean over a class's objects of their accuracy",
    "class_accuracy": "mean over a class's objects of their accuracy",
    "by_object": "each object's share of test sequences correctly classified, over all splits that tested it, and "
    "its weight in accuracy",
    "interval": "over objects, for fixed trained classifiers: quantiles of the mean with random weights of the objects "
    "and of an extra object; the extra object has the value of the worst object, or the worst possible value while "
    "the others have the best value, and the wider interval counts",
    "new_classes": "the interval if classes are a sample, too: the wider of the interval over objects and of Student's "
    "interval of the means of classes, with one degree of freedom fewer than classes; none with one class",
    "comparison": "paired over the objects that both strategies tested, weighted as by fixation: mean difference, its "
    "interval and two-sided p value. The interval over objects has the means that the sign-change "
    "permutation test or the rule of unobserved failures does not reject, and the p value is the larger of both; new_classes "
    "adds Student's test of the means of classes. A p value is below 1 - confidence exactly if its interval excludes 0",
    "leads": "accuracy by one strategy minus accuracy by another, mean over draws: seeing, fixation minus random places "
    "in reach; sight, random places in sight minus random places in reach; salience, fixation minus random places in "
    "sight",
    "own_fixations": "touches by fixation, compared with the first n fixations of each view: shares of touches and of "
    "views, each with its own count as denominator",
    "draws": "for a random strategy with several draws of the places, accuracy, balanced_accuracy, class_accuracy, "
    "by_object and difference use each object's mean over draws; leads are fixation minus each draw, and "
    "standard_deviation is the standard deviation of the leads (n - 1); object_accuracy and predictions are of draw 0",
}


@dataclass(frozen=True)
class Confusion:
    """Counts (c, c) of sequences by true class (row) and predicted class (column)."""

    classes: tuple[str, ...]
    counts: IntArray


@dataclass(frozen=True)
class _ObjectFigures:
    """Accuracy and vote of each object, as means over the splits and repeats that tested the object."""

    objects: tuple[tuple[str, str], ...]
    classes: IntArray
    weights: FloatArray
    vote_weights: FloatArray
    accuracy: FloatArray
    vote: FloatArray

    @property
    def object_accuracies(self) -> ObjectAccuracies:
        """The accuracies and weights, without classes and votes."""
        return ObjectAccuracies(self.objects, self.accuracy, self.weights)

    def over(self, further: FurtherDraws | None) -> _ObjectFigures:
        """Return the figures with accuracies and weights as means over this draw and further draws."""
        if further is None:
            return self
        mean = mean_over_draws([self.object_accuracies, *further.draws])
        return replace(self, accuracy=mean.accuracy, weights=mean.weights)


def summarise(
    scores: pa.Table,
    predictions: pa.Table,
    parameters: IntervalParameters | None = None,
    drawn: pa.Table | None = None,
) -> dict[str, Any]:
    """Compute every headline figure of recognition, in types that JSON has.

    Parameters
    ----------
    scores : pyarrow.Table
        Rows of `tables.SCORES`.
    predictions : pyarrow.Table
        Rows of `tables.PREDICTIONS` of the same run.
    parameters : IntervalParameters, optional
        The confidence of the intervals and the number of permutations.
    drawn : pyarrow.Table, optional
        Rows of `tables.STUDY` with further draws of random strategies. Figures of these strategies are then means
        over draws, and ``draws`` has the accuracy or the lead of each draw.

    Returns
    -------
    dict
        ``results[pipeline][strategy][classifier]`` has the figures, and ``method`` describes each of them. An interval
        has ``mean``, ``low`` and ``high``; a missing end is None. The name of an interval of new classes ends in
        ``_new_classes``. ``comparisons[pipeline][classifier][strategy]`` compares fixation with the strategy: fixation
        minus the strategy. ``leads[pipeline][classifier]`` has the leads of `evaluation.leads.LEADS`
        between measured strategies.

    Raises
    ------
    RecognitionError
        If scores and predictions are not of the same run.
    """
    parameters = parameters or IntervalParameters()
    cells = _cells(predictions)
    scored = {tuple(row.values()) for row in _distinct(scores, _CELL)}
    if scored != set(cells):
        raise RecognitionError(
            f"Only one of scores and predictions has {sorted(scored ^ set(cells))[0]}; both must come "
            f"from the same run."
        )
    figures = {key: _object_figures(rows) for key, rows in cells.items()}
    drawn_cells = further_draws(drawn)
    further = {key: draws for key, draws in drawn_cells.items() if key in figures}
    results: dict[str, Any] = {}
    for key in sorted(cells):
        pipeline, strategy, classifier = key
        over_draws = figures[key].over(further.get(key))
        cell = _summarise_cell(key, over_draws, scores, parameters)
        if key in further:
            cell |= _describe_draws(figures[key].object_accuracies, further[key], cell["notes"])
        cell["sequences"] = len(_distinct(cells[key], ["class", "object", "viewpoint"]))
        results.setdefault(pipeline, {}).setdefault(strategy, {})[classifier] = cell
    return {
        "method": METHOD,
        "results": results,
        "comparisons": _compare_strategies(figures, further, parameters),
        "leads": _leads(figures, drawn_cells, parameters),
    }


def confusion(predictions: pa.Table) -> Confusion:
    """Count sequences by true and predicted class.

    `predictions` are rows of `tables.PREDICTIONS`, usually of one pipeline, strategy and classifier.
    """
    true, predicted = _texts(predictions, "class"), _texts(predictions, "predicted")
    classes, codes = np.unique(np.concatenate([true, predicted]), return_inverse=True)
    counts = np.zeros((len(classes), len(classes)), dtype=np.int64)
    np.add.at(counts, (codes[: len(true)], codes[len(true) :]), 1)
    return Confusion(tuple(str(name) for name in classes), counts)


def select(table: pa.Table, **values: object) -> pa.Table:
    """Return the rows that have the given values in the named columns, such as ``strategy="random"``."""
    for name, value in values.items():
        table = table.filter(pc.equal(table.column(name), pa.scalar(value)))
    return table


def _cells(predictions: pa.Table) -> dict[PredictionKey, pa.Table]:
    rows = _distinct(predictions, _CELL)
    return {PredictionKey(**row): select(predictions, **row) for row in rows}


def _distinct(table: pa.Table, names: list[str]) -> list[dict[str, Any]]:
    return table.select(names).group_by(names).aggregate([]).to_pylist()


def _texts(table: pa.Table, name: str) -> NDArray[np.str_]:
    return np.array(table.column(name).to_pylist(), dtype=np.str_)


def _object_figures(rows: pa.Table) -> _ObjectFigures:
    """Average each object's accuracy and vote over the splits and repeats that tested the object."""
    # With these weights the weighted mean over objects equals the mean over splits: of the share of correct
    # sequences, or of the share of correct votes.
    owners = owners_of(rows)
    objects = tuple(sorted(set(owners)))
    index_of = {owner: index for index, owner in enumerate(objects)}
    owner = np.array([index_of[name] for name in owners], dtype=np.int64)
    names, codes = np.unique(
        np.concatenate([_texts(rows, "predicted"), [name for name, _ in objects]]),
        return_inverse=True,
    )
    predicted, true_class = codes[: len(owner)], codes[len(owner) :]
    split = rows.column("split").to_numpy().astype(np.int64)
    repeat = rows.column("seed").to_numpy().astype(np.int64)
    _, run = np.unique(split * (repeat.max() + 1) + repeat, return_inverse=True)
    tests = run * len(objects) + owner
    test, test_of_row = np.unique(tests, return_inverse=True)
    sequences = np.bincount(test_of_row)
    correct = np.bincount(test_of_row, weights=predicted == true_class[owner])
    credit = _vote_credit(rows, test_of_row, predicted, true_class[test % len(objects)], names)
    run, tested = np.divmod(test, len(objects))
    share = sequences / np.bincount(run, weights=sequences)[run]
    object_share = 1.0 / np.bincount(run)[run]
    weights: FloatArray = np.bincount(tested, weights=share).astype(np.float64)
    vote_weights: FloatArray = np.bincount(tested, weights=object_share).astype(np.float64)
    return _ObjectFigures(
        objects,
        true_class,
        weights,
        vote_weights,
        np.bincount(tested, weights=share * correct / sequences) / weights,
        np.bincount(tested, weights=object_share * credit) / vote_weights,
    )


def _vote_credit(
    rows: pa.Table,
    test: IntArray,
    predicted: IntArray,
    true_class: IntArray,
    names: NDArray[np.str_],
) -> FloatArray:
    """Return the credit of each test in [0, 1]: from column ``voted`` if complete, else by majority."""
    if rows.column("voted").null_count:
        return vote_credit(test, predicted, true_class)[1]
    voted = np.zeros(len(true_class), dtype=names.dtype)
    voted[test] = _texts(rows, "voted")
    return (voted == names[true_class]).astype(np.float64)


def _summarise_cell(
    key: tuple[str, str, str],
    figures: _ObjectFigures,
    scores: pa.Table,
    parameters: IntervalParameters,
) -> dict[str, Any]:
    rows = select(scores, **dict(zip(_CELL, key, strict=True)))
    names = np.array([name for name, _ in figures.objects])

    def rate(values: FloatArray, weights: FloatArray) -> dict[str, float | None]:
        return plain_interval(object_interval(values, weights, parameters))

    def rate_of_classes(values: FloatArray, weights: FloatArray) -> dict[str, float | None]:
        return plain_interval(class_interval(values, weights, figures.classes, parameters))

    return {
        "accuracy": rate(figures.accuracy, figures.weights),
        "accuracy_new_classes": rate_of_classes(figures.accuracy, figures.weights),
        "object_accuracy": rate(figures.vote, figures.vote_weights),
        "object_accuracy_new_classes": rate_of_classes(figures.vote, figures.vote_weights),
        "balanced_accuracy": plain_interval(
            balanced_interval(figures.accuracy, figures.classes, parameters)
        ),
        "balanced_accuracy_new_classes": plain_interval(
            balanced_class_interval(figures.accuracy, figures.classes, parameters)
        ),
        "class_accuracy": {
            name: rate(figures.accuracy[names == name], np.ones(np.sum(names == name)))
            for name in np.unique(names).tolist()
        },
        "by_object": {
            "/".join(name): [float(accuracy), float(weight)]
            for name, accuracy, weight in zip(
                figures.objects, figures.accuracy, figures.weights, strict=True
            )
        },
        "splits": len(set(rows.column("split").to_pylist())),
        "repeats": len(set(rows.column("seed").to_pylist())),
        "objects": len(figures.objects),
        "notes": sorted(set(filter(None, rows.column("note").to_pylist()))),
    }


def _describe_draws(
    first: ObjectAccuracies, further: FurtherDraws, notes: list[str]
) -> dict[str, Any]:
    accuracies = [draw.mean for draw in (first, *further.draws)]
    return {
        "draws": {"count": len(accuracies), "accuracies": accuracies},
        "notes": [*notes, *further.notes],
    }


def _leads(
    figures: Mapping[PredictionKey, _ObjectFigures],
    drawn: Mapping[PredictionKey, FurtherDraws],
    parameters: IntervalParameters,
) -> dict[str, Any]:
    """Compute the leads of each pipeline and classifier; a strategy that only `drawn` has, counts with these draws."""
    measured: dict[tuple[str, str], dict[str, DrawnAccuracies]] = {}
    for key in sorted({*figures, *drawn}):
        own = (figures[key].object_accuracies,) if key in figures else ()
        draws = (*own, *(drawn[key].draws if key in drawn else ()))
        if draws:
            by_strategy = measured.setdefault((key.pipeline, key.classifier), {})
            by_strategy[key.strategy] = DrawnAccuracies(draws)
    leads: dict[str, Any] = {}
    for (pipeline, classifier), by_strategy in measured.items():
        found = compare_by_lead(by_strategy, parameters)
        if found:
            leads.setdefault(pipeline, {})[classifier] = found
    return leads


def _compare_strategies(
    figures: Mapping[PredictionKey, _ObjectFigures],
    further: Mapping[PredictionKey, FurtherDraws],
    parameters: IntervalParameters,
) -> dict[str, Any]:
    comparisons: dict[str, Any] = {}
    for key in sorted(figures):
        pipeline, strategy, classifier = key
        fixation = figures.get(key._replace(strategy=REFERENCE_STRATEGY))
        if fixation is None or strategy == REFERENCE_STRATEGY:
            continue
        draws = [figures[key].object_accuracies, *(further[key].draws if key in further else ())]
        reference, other = in_common(fixation.object_accuracies, mean_over_draws(draws))
        if not other.objects:
            raise RecognitionError(
                f"Strategies {REFERENCE_STRATEGY} and {strategy} were tested on no object in common; "
                f"at least one is needed to compare them."
            )
        comparison = compare_paired(
            reference.accuracy,
            other.accuracy,
            reference.weights,
            parameters,
            reference.classes,
        )
        entry = plain_comparison(comparison)
        if key in further:
            entry["draws"] = plain_lead(lead_over_draws(fixation.object_accuracies, draws))
        comparisons.setdefault(pipeline, {}).setdefault(classifier, {})[strategy] = entry
    return comparisons
