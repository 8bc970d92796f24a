"""Any classifier on the experiment's own protocol: accuracy, interval, and seconds."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from joblib import Parallel, delayed
from sklearn.base import clone
from sklearn.utils import get_tags
from sklearn.utils.validation import has_fit_parameter
from tqdm import tqdm

from visuohaptic.base.arrays import IntArray
from visuohaptic.base.errors import ParameterError, RecognitionError, TableError, VisuohapticError
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.evaluation.inputs import SCHEMAS, Inputs, Prepared, check_inputs, prepare
from visuohaptic.evaluation.intervals import PairedComparison, compare_paired
from visuohaptic.evaluation.own_splits import Splits, choose_splits
from visuohaptic.evaluation.summary import summarise
from visuohaptic.recognition.classifiers import CLASSIFIERS, Classifier
from visuohaptic.recognition.experiment import (
    SplitPrediction,
    one_thread,
    prediction_tables,
    seeded,
)
from visuohaptic.recognition.parameters import IntervalParameters, RecognitionParameters
from visuohaptic.recognition.sequences import take_strategy
from visuohaptic.recognition.splits import Split
from visuohaptic.tables.phases import FEATURES, TOUCHES
from visuohaptic.tables.schema import Schema, read_table, take_table


@dataclass(frozen=True)
class Seconds:
    """Time of one kind of work: seconds of the processor, over all threads of the process, and on the clock."""

    processor: float = 0.0
    wall: float = 0.0

    def __add__(self, other: Seconds) -> Seconds:
        return Seconds(self.processor + other.processor, self.wall + other.wall)

    def __str__(self) -> str:
        return f"{self.processor:.3g} s of processor, {self.wall:.3g} s on the clock"


@dataclass(frozen=True, eq=False)
class Evaluation:
    """How often test sequences are correctly classified; it is equal to itself alone.

    Attributes
    ----------
    accuracy : float
        Mean over splits of the share of test sequences that are correctly classified.
    low, high : float or None
        Its interval over objects, as the report's; None where there is no such end.
    by_object : mapping of str to float
        The same of each object, `class/name`.
    splits : int
        How often the objects were divided into training and test objects.
    predictions : pyarrow.Table
        `tables.PREDICTIONS`: a row for each tested sequence of each split.
    weights : mapping of str to float
        Each object's weight in `accuracy`.
    fit, predict : Seconds
        Time of all fits and of all predictions, summed over splits. Scaling, map and rotation that are fitted per
        split count; looking, touching, and what is computed once for all splits do not. Processor time leaves out
        processes that the classifier starts.
    """

    accuracy: float
    low: float | None
    high: float | None
    by_object: Mapping[str, float]
    splits: int
    predictions: pa.Table
    weights: Mapping[str, float]
    fit: Seconds
    predict: Seconds

    def __repr__(self) -> str:
        ends = ("none" if end is None else f"{100 * end:.1f}" for end in (self.low, self.high))
        return (
            f"<Evaluation: {100 * self.accuracy:.1f} % correctly classified ({' to '.join(ends)}), "
            f"{len(self.by_object)} objects, {self.splits} splits; fit {self.fit}; predict {self.predict}>"
        )

    def compare(
        self, other: Evaluation, parameters: IntervalParameters | None = None
    ) -> PairedComparison:
        """Compare with another classifier in pairs over the objects that both tested, as the report does.

        Parameters
        ----------
        other : Evaluation
            What is subtracted.
        parameters : IntervalParameters, optional
            Confidence and sign changes; without them those of the default run.

        Returns
        -------
        PairedComparison
            The mean difference by this evaluation's weights, its interval, and a two-sided p value.

        Raises
        ------
        RecognitionError
            If both tested no object in common.
        """
        objects = [name for name in self.by_object if name in other.by_object]
        if not objects:
            raise RecognitionError(
                "Both evaluations tested no object in common; at least one is needed to compare them."
            )
        first, second, weights = (
            np.array([values[name] for name in objects])
            for values in (self.by_object, other.by_object, self.weights)
        )
        return compare_paired(first, second, weights, parameters or IntervalParameters())


def evaluate(
    estimator: Any,
    table: Any,
    parameters: RecognitionParameters | None = None,
    strategy: str = "fixation",
    seed: int = 2018,
    n_jobs: int = 1,
    *,
    inputs: Inputs = "features",
    splits: Splits = None,
) -> Evaluation:
    """Train and test a classifier on every split of the experiment, as the report does.

    Parameters
    ----------
    estimator : object or str
        An unfitted scikit-learn classifier, of which each split fits a copy, or the name of a registered one, such
        as ``support_vector_machine``. `y` are whole numbers from 0, one per class. A `fit` with a parameter
        `groups` also gets the object of each training sequence, (n,), as whole numbers. Parameters
        `random_state` that are None, those of nested estimators too, get seeds.
    table : pyarrow.Table, data frame, mapping of arrays or path
        Rows of `tables.FEATURES`: a run's ``results/features``, `Exploration.features` of several objects, or an
        exported data set's ``features``. With `inputs` ``touches`` rows of `tables.TOUCHES`, such as
        ``results/touches``. Other columns are left out.
    parameters : RecognitionParameters, optional
        The protocol, the sequences, and their encoding; without it those of the default run.
    strategy : str
        How the touches were chosen.
    seed : int
        The experiment's seed, which draws the splits; by default that of the default run.
    n_jobs : int
        Processes that share the splits, -1 for one per processor. The result does not depend on the number.
    inputs : {"features", "descriptors", "touches"}
        What the classifier gets per sequence. ``features``: the paper's 60 numbers. ``descriptors``: the numbers
        of our pipeline `order_free`, scaled and rotated as its classifiers get them. Scaling, map and rotation are
        fitted on training objects only. ``touches``: imprints and poses, a structured array of shape (n, t), as
        `recognition.touch_arrays` returns it; `recognition.flatten_touches` makes it two-dimensional.
    splits : int, iterable or scikit-learn splitter, optional
        None for all splits of the protocol. A number for so many of them: of combinations of one object per class a
        balanced sample, of folds the first ones. The test objects, ``class/name``, of each split; all other objects
        train. Or a splitter, which gets the objects as `groups`.

    Returns
    -------
    Evaluation
        The accuracy, its interval, and the seconds that fitting and predicting took.

    Raises
    ------
    ParameterError
        If `inputs` or `splits` are not allowed.
    RecognitionError
        If the table does not allow the experiment, the classifier can't be copied, fitted or tested, or it predicts
        labels that are not in `y`.

    Examples
    --------
    >>> from sklearn.svm import SVC
    >>> evaluate(SVC(C=10), "results/features", inputs="descriptors", splits=9)  # doctest: +SKIP
    """
    if parameters is None:
        parameters = RecognitionParameters()
    if not isinstance(parameters, RecognitionParameters):
        raise ParameterError(
            f"parameters is of type {type(parameters).__name__}; RecognitionParameters are needed."
        )
    inputs = check_inputs(inputs)
    if isinstance(estimator, str):
        classifier = CLASSIFIERS[estimator]
    else:
        check_classifier(estimator)
        classifier = Classifier.of("estimator", estimator)
    whole = _of_strategy(_as_table(table, SCHEMAS[inputs]), strategy, parameters.touches)
    prepared = prepare(inputs, whole, classifier, parameters, seed)
    chosen = choose_splits(prepared.sequences, parameters.protocol, seed, splits)
    tested = _test_splits(estimator, prepared, chosen, seed, n_jobs)
    name = prepared.pipeline.name
    scores, predictions = prediction_tables(
        prepared.sequences, [one.prediction for one in tested], name, strategy
    )
    summary = summarise(scores, predictions, parameters.intervals)
    ((found,),) = (one.values() for one in summary["results"][name].values())
    accuracy = found["accuracy"]
    return Evaluation(
        accuracy["mean"], accuracy["low"], accuracy["high"],
        {key: mean for key, (mean, _) in found["by_object"].items()},
        len(chosen), predictions,
        {key: weight for key, (_, weight) in found["by_object"].items()},
        sum((one.fit for one in tested), Seconds()),
        sum((one.predict for one in tested), Seconds()),
    )  # fmt: skip


@dataclass(frozen=True)
class _Tested:
    """Predictions of one split and the time that they took."""

    prediction: SplitPrediction
    fit: Seconds
    predict: Seconds


def _test_splits(
    estimator: Any, prepared: Prepared, splits: list[Split], seed: int, n_jobs: int
) -> list[_Tested]:
    parts = Parallel(n_jobs, return_as="generator")(
        delayed(_test_split)(prepared, split, seed, _short(estimator)) for split in splits
    )
    progress = tqdm(parts, "evaluating", len(splits), leave=False, disable=None, unit="split")
    try:
        return list(progress)
    except VisuohapticError:
        raise
    # An estimator that no other process can take over fails in any way.
    except Exception as error:
        raise RecognitionError(
            f"{_short(estimator)} can't be shared between processes: {_reason(error)}; set n_jobs to 1."
        ) from error


@one_thread()
def _test_split(prepared: Prepared, split: Split, seed: int, described: str) -> _Tested:
    """Fit and test a classifier on one split, as `recognition.experiment.predict_split` does."""
    pipeline, sequences = prepared.pipeline, prepared.sequences
    generator = spawn_generator(seed, "recognition", pipeline.name, split.repeat, split.number)
    labels, owners = sequences.labels[split.train], sequences.object_index[split.train]
    train = prepared.rows[split.train]
    started = _clock()
    try:
        preparation = seeded(clone(pipeline.preparation), generator).fit(train)
        train = preparation.transform(train)
        ((name, own_seed),) = pipeline.seeds(generator).items()
        model = _seeded_deeply(clone(pipeline.classifiers[name]), own_seed)
        groups = {"groups": owners} if has_fit_parameter(model, "groups") else {}
        model.fit(train, labels, **groups)
        fitted = _clock()
        predicted = model.predict(preparation.transform(prepared.rows[split.test]))
    except VisuohapticError:
        raise
    # An estimator may fail in any way.
    except Exception as error:
        raise RecognitionError(
            f"{described} can't be fitted or tested on {_described(train)}: {_reason(error)}."
        ) from error
    ended = _clock()
    found = _checked(predicted, split, len(sequences.classes), described)
    note = getattr(model, "note_", None)
    return _Tested(
        SplitPrediction(split, name, found, None, note),
        _between(started, fitted),
        _between(fitted, ended),
    )


def _seeded_deeply(estimator: Any, seed: int) -> Any:
    """Set the `random_state` of an estimator, and those of nested estimators that have none."""
    nested = [
        name
        for name, value in estimator.get_params(deep=True).items()
        if name.endswith("__random_state") and value is None
    ]
    if nested:
        estimator.set_params(**dict.fromkeys(nested, seed))
    return seeded(estimator, seed)


def _checked(predicted: Any, split: Split, classes: int, described: str) -> IntArray:
    """Return predicted labels as whole numbers, and refuse what is none of the labels."""
    found = np.asarray(predicted)
    if found.shape != split.test.shape:
        raise RecognitionError(
            f"{described} predicted an array of shape {found.shape} for {len(split.test)} sequences; one label "
            f"per sequence, shape ({len(split.test)},), is needed."
        )
    allowed = np.isin(found, np.arange(classes))
    if not allowed.all():
        raise RecognitionError(
            f"{described} predicted the label {found[~allowed][0]!s:.40}; only labels of y, which are 0 to "
            f"{classes - 1}, are allowed."
        )
    return found.astype(np.int64)


def check_classifier(estimator: Any) -> None:
    """Raise `RecognitionError`, which says why, unless an object is a scikit-learn classifier that can be copied."""
    if isinstance(estimator, type):
        raise RecognitionError(
            f"{estimator.__name__} is a class; an object of it is needed, such as {estimator.__name__}()."
        )
    missing = [name for name in ("get_params", "fit") if not hasattr(estimator, name)]
    kind = "of another kind"
    if not missing and hasattr(estimator, "__sklearn_tags__"):
        tagged = get_tags(estimator).estimator_type
        if tagged == "classifier":
            _check_clone(estimator)
            return
        kind = f"of the kind {tagged.replace('_', ' ')}" if tagged else "no estimator of classes"
    elif not missing and hasattr(estimator, "predict"):
        _check_clone(estimator)
        return
    raise RecognitionError(
        f"{_short(estimator)} is {kind if not missing else f'without {missing[0]}'}; a scikit-learn classifier is needed."
    )


def _check_clone(estimator: Any) -> None:
    """Refuse an estimator that scikit-learn can't copy: each split fits a copy."""
    try:
        clone(estimator)
    except Exception as error:
        raise RecognitionError(
            f"{_short(estimator)} can't be copied by sklearn.base.clone: {_reason(error)}; its constructor has to "
            "store each argument, unchanged, under the argument's name."
        ) from error


def _described(rows: Any) -> str:
    fields = rows.dtype.names
    if not fields:
        return f"rows of shape {rows.shape}"
    named = (f"{name} {rows[name].shape}" for name in fields)
    return f"a structured array of shape {rows.shape} with the fields {', '.join(named)}"


def _short(estimator: Any) -> str:
    text = " ".join(repr(estimator).split())
    return text if len(text) <= 100 else f"{text[:100]}…"


def _reason(error: BaseException) -> str:
    return (" ".join(str(error).split()) or type(error).__name__).rstrip(".")


def _clock() -> Seconds:
    return Seconds(time.process_time(), time.perf_counter())


def _between(start: Seconds, end: Seconds) -> Seconds:
    return Seconds(end.processor - start.processor, end.wall - start.wall)


def _of_strategy(table: pa.Table, strategy: str, touches: int | None) -> pa.Table:
    """Take the whole sequences of one strategy and of classes with at least two objects."""
    # pyarrow joins no tables with lists: rows are chosen by their keys, images by the rows.
    lists = [field.name for field in table.schema if pa.types.is_list(field.type)]
    numbered = table.drop_columns(lists).append_column("row", [np.arange(len(table))])
    whole, _ = take_strategy(numbered, strategy, touches)
    return table.take(whole.column("row"))


def _as_table(given: Any, schema: Schema) -> pa.Table:
    read = read_table if isinstance(given, str | Path) else take_table
    try:
        return read(schema, given)
    except TableError as error:
        if schema is TOUCHES and _are_features(given, read):
            raise RecognitionError(
                "The table has no imprints (column image); a table of touches is needed, such as results/touches."
            ) from error
        raise RecognitionError(f"The {schema.name} can't be used: {error}") from error


def _are_features(given: Any, read: Callable[[Schema, Any], pa.Table]) -> bool:
    try:
        read(FEATURES, given)
    except TableError:
        return False
    return True
