"""Evaluate any classifier with the splits of the experiment: accuracy, its interval, and time in seconds."""

from __future__ import annotations

import time
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from joblib import Parallel, delayed
from sklearn import config_context, get_config
from sklearn.base import BaseEstimator, clone
from sklearn.decomposition import PCA
from sklearn.model_selection import GridSearchCV, RandomizedSearchCV
from sklearn.preprocessing import (
    MaxAbsScaler,
    MinMaxScaler,
    PowerTransformer,
    QuantileTransformer,
    RobustScaler,
    StandardScaler,
)
from sklearn.utils import get_tags
from sklearn.utils.metadata_routing import get_routing_for_object
from sklearn.utils.validation import has_fit_parameter
from tqdm import tqdm

from visuohaptic.base.arrays import IntArray, masked_fault
from visuohaptic.base.errors import (
    ParameterError,
    RecognitionError,
    RecognitionWarning,
    TableError,
    VisuohapticError,
)
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.evaluation.inputs import SCHEMAS, Inputs, Prepared, check_inputs, prepare
from visuohaptic.evaluation.intervals import PairedComparison, compare_paired
from visuohaptic.evaluation.own_splits import Splits, choose_splits, is_whole
from visuohaptic.evaluation.summary import summarise
from visuohaptic.evaluation.wording import reason_of, short
from visuohaptic.evaluation.wrong_tables import check_classes_are_named, why_no_table
from visuohaptic.recognition.classifiers import CLASSIFIERS, Classifier
from visuohaptic.recognition.experiment import (
    SplitPrediction,
    one_thread,
    prediction_tables,
    seeded,
)
from visuohaptic.recognition.parameters import IntervalParameters, RecognitionParameters
from visuohaptic.recognition.pipelines import fit_preparation
from visuohaptic.recognition.sequences import take_strategy
from visuohaptic.recognition.splits import Split
from visuohaptic.tables.schema import Schema, read_table, take_table

_ROUTING = "enable_metadata_routing"
"""Setting of scikit-learn under which `fit` passes arguments on to nested estimators and splitters."""

_MOST_NAMED = 10
"""Most classes that a note names."""

_SCALERS = (
    MaxAbsScaler,
    MinMaxScaler,
    PowerTransformer,
    QuantileTransformer,
    RobustScaler,
    StandardScaler,
)
"""Transformers that bring each column to the same spread."""


@dataclass(frozen=True)
class Seconds:
    """Seconds of processor time, summed over all threads of the process, and of wall time."""

    processor: float = 0.0
    wall: float = 0.0

    def __add__(self, other: Seconds) -> Seconds:
        return Seconds(self.processor + other.processor, self.wall + other.wall)

    def __str__(self) -> str:
        return f"{self.processor:.3g} s of processor, {self.wall:.3g} s on the clock"


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Accuracy of a classifier on test sequences. Operator ``==`` is True only for the same Python object.

    Attributes
    ----------
    accuracy : float
        Mean over splits of the share of test sequences that are correctly classified, in [0, 1].
    low, high : float or None
        Ends of the interval of `accuracy` over objects, by `intervals.object_interval`. With a single object both
        are None.
    by_object : mapping of str to float
        For each tested object, the mean accuracy over the splits that tested the object. Keys are ``class/name``.
    splits : int
        The number of splits into training and test objects.
    predictions : pyarrow.Table
        `tables.PREDICTIONS` with one row per test sequence and split.
    weights : mapping of str to float
        Weight of each object: `accuracy` is the weighted mean of `by_object`. The weights sum to `splits`. Keys are
        ``class/name``.
    fit, predict : Seconds
        Time of all fits and of all predictions, summed over splits. `fit` includes the fit of the preparation
        (scaling, self-organising map, PCA rotation) and its transform of training sequences. `predict` includes its
        transform of test sequences. The time of steps before the splits, such as touching, is not included.
        Processor time does not include processes that the classifier starts.
    notes : tuple of str
        What limits the meaning of the accuracy, such as a singular covariance, or a scaling of rotated descriptors.
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
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        notes = "".join(f"; note: {note}" for note in self.notes)
        ends = ("none" if end is None else f"{100 * end:.1f}" for end in (self.low, self.high))
        return (
            f"<Evaluation: {100 * self.accuracy:.1f} % correctly classified ({' to '.join(ends)}), "
            f"{len(self.by_object)} objects, {self.splits} splits; fit {self.fit}; predict {self.predict}{notes}>"
        )

    def compare(
        self, other: Evaluation, parameters: IntervalParameters | None = None
    ) -> PairedComparison:
        """Compare two classifiers, paired over the objects that both tested.

        Parameters
        ----------
        other : Evaluation
            The evaluation to subtract. Its splits may differ from the splits of this evaluation.
        parameters : IntervalParameters, optional
            Confidence of the interval and largest number of sign changes; by default ``IntervalParameters()``, also
            if the evaluation used other parameters.

        Returns
        -------
        PairedComparison
            The mean over objects of this accuracy minus the other, weighted by `self.weights`. It has intervals and
            two-sided p values of new objects and of new classes, computed by `intervals.compare_paired`.

        Raises
        ------
        RecognitionError
            If the evaluations have no object in common.
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
        classes = [name.partition("/")[0] for name in objects]
        return compare_paired(first, second, weights, parameters or IntervalParameters(), classes)


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
    """Train and test a classifier on each split; with the defaults, the splits are those of the report.

    Parameters
    ----------
    estimator : object or str
        An unfitted scikit-learn classifier, or the name of a registered classifier, such as
        ``support_vector_machine``. Each split fits a copy. `y` (n,) has the class indices, from 0, of the n training
        sequences. If `fit` has a parameter `groups`, `groups` (n,) has the object index of each training sequence. A
        splitter within the estimator that takes groups gets them, too, such as ``GridSearchCV(SVC(), grid,
        cv=GroupKFold(2))``, also as the last step of a pipeline. Predictions have shape (n,) or (n, 1).
        Parameter `random_state` of the copy is replaced by a seed of the split, even if set. In nested estimators
        and splitters only a `random_state` that is None is replaced.
    table : pyarrow.Table, data frame, mapping of arrays or path
        Rows of `tables.FEATURES`: a run's ``results/features``, `Exploration.features` of several objects, or an
        exported data set's ``features``. With `inputs` ``touches``, rows of `tables.TOUCHES`, such as
        ``results/touches``. Columns outside the schema are ignored. Sequences with fewer than `parameters.touches`
        touches are dropped; with None, sequences shorter than the longest. Then classes with fewer than two objects
        are dropped, and named in `Evaluation.notes`.
    parameters : RecognitionParameters, optional
        The protocol, the sequences, their encoding, and the interval; by default ``RecognitionParameters()``. Fields
        that name pipelines and classifiers are not used.
    strategy : str
        The probing strategy of the evaluated rows. Rows of other strategies are ignored.
    seed : int
        The experiment's seed. All random choices depend on this seed: splits, self-organising map, and seeds of the
        classifier. The default is that of a run with default parameters.
    n_jobs : int
        The number of processes, -1 for one per processor. The result does not depend on it.
    inputs : {"features", "descriptors", "touches"}
        The classifier's input `X`, one row per sequence. ``features``: the numbers of pipeline `paper` (60 by
        default), from a self-organising map, then scaled. ``descriptors``: the numbers of pipeline `order_free`,
        scaled and rotated by PCA. Scaling, map and rotation are fitted on training sequences only. ``touches``:
        imprints and poses of t touches, a structured array of shape (n, t) as from `recognition.touch_arrays`.
        `recognition.flatten_touches` converts this array to two dimensions.
    splits : int, iterable or scikit-learn splitter, optional
        None: all splits of the protocol. A number k: if the protocol tests one object per class
        (``leave_one_object_a_class_out``), a balanced sample of k combinations; for other protocols, the first k
        splits. There may be fewer than k. An iterable: one list of test objects, ``class/name``, per split; all
        other objects are training objects. A splitter gets the object indices as `groups`, and gives indices or
        masks of sequences.

    Returns
    -------
    Evaluation
        The accuracy, its interval, and the seconds of fits and predictions.

    Warns
    -----
    RecognitionWarning
        If the classifier scales each column of `inputs` ``descriptors``, such as a pipeline with a ``StandardScaler``.
        These columns are scaled already, then rotated, so that the last of them hold noise. The sentence is also in
        `Evaluation.notes`.

    Raises
    ------
    ParameterError
        If `seed`, `n_jobs`, `inputs` or `splits` is not allowed, or `parameters` has another type.
    RegistryError
        If no registered classifier has the name `estimator`.
    RecognitionError
        If the table can't be read or has too few sequences, a splitter fails, a split of the caller trains and tests
        the same object, the classifier can't be copied, fitted or tested, or a predicted label is not in `y`.

    Examples
    --------
    >>> from sklearn.svm import SVC
    >>> evaluate(SVC(C=10), "results/features", inputs="descriptors", splits=9)  # doctest: +SKIP
    """
    if parameters is None:
        parameters = RecognitionParameters()
    if not isinstance(parameters, RecognitionParameters):
        raise ParameterError(
            f"parameters is of type {type(parameters).__name__}; RecognitionParameters is needed."
        )
    if not is_whole(seed) or seed < 0:
        raise ParameterError(f"seed is {seed!r}; a whole number of at least 0 is needed.")
    if not is_whole(n_jobs) or n_jobs == 0:
        raise ParameterError(f"n_jobs is {n_jobs!r}; a whole number other than 0 is needed.")
    inputs = check_inputs(inputs)
    if isinstance(estimator, str):
        classifier = CLASSIFIERS[estimator]
    else:
        check_classifier(estimator)
        classifier = Classifier.of("estimator", estimator)
    rows = _as_table(table, SCHEMAS[inputs])
    check_classes_are_named(rows)
    whole = _take_strategy_rows(rows, strategy, parameters.touches)
    notes = _note_of_left_out(rows, whole, strategy)
    prepared = prepare(inputs, whole, classifier, parameters, seed)
    if inputs == "descriptors" and (scaler := _scaler_in(prepared.pipeline.classifiers)):
        notes.append(_scaled_twice(scaler))
        warnings.warn(notes[-1], RecognitionWarning, stacklevel=2)
    chosen = choose_splits(prepared.sequences, parameters.protocol, seed, splits)
    tests = _test_splits(estimator, prepared, chosen, seed, n_jobs)
    name = prepared.pipeline.name
    scores, predictions = prediction_tables(
        prepared.sequences, [test.prediction for test in tests], name, strategy
    )
    summary = summarise(scores, predictions, parameters.intervals)
    (figures,) = summary["results"][name][strategy].values()
    accuracy = figures["accuracy"]
    return Evaluation(
        accuracy["mean"], accuracy["low"], accuracy["high"],
        {key: mean for key, (mean, _) in figures["by_object"].items()},
        len(chosen), predictions,
        {key: weight for key, (_, weight) in figures["by_object"].items()},
        sum((test.fit for test in tests), Seconds()),
        sum((test.predict for test in tests), Seconds()),
        (*notes, *figures["notes"]),
    )  # fmt: skip


def _scaler_in(classifiers: Mapping[str, Any]) -> str | None:
    """Return the name of the first transformer within classifiers that brings columns to one spread; None without it."""
    for classifier in classifiers.values():
        nested = classifier.get_params().values() if isinstance(classifier, BaseEstimator) else ()
        for part in nested:
            if isinstance(part, _SCALERS) and getattr(part, "with_std", True):
                return type(part).__name__
            if isinstance(part, PCA) and part.whiten:
                return "PCA(whiten=True)"
    return None


def _scaled_twice(scaler: str) -> str:
    return (
        f"{scaler} brings all columns to one spread, but descriptors are scaled already and then rotated, so that their "
        "last columns hold noise; leave the scaling out, or take inputs='features'."
    )


@dataclass(frozen=True)
class _SplitTest:
    """Predictions for the test sequences of one split, and the time of the fit and of the predictions."""

    prediction: SplitPrediction
    fit: Seconds
    predict: Seconds


def _test_splits(
    estimator: Any, prepared: Prepared, splits: list[Split], seed: int, n_jobs: int
) -> list[_SplitTest]:
    """Fit and test a copy of the classifier on each split, in `n_jobs` processes."""
    parts = Parallel(n_jobs, return_as="generator")(
        delayed(_test_split)(prepared, split, seed, short(estimator)) for split in splits
    )
    progress = tqdm(parts, "evaluating", len(splits), leave=False, disable=None, unit="split")
    try:
        return list(progress)
    except VisuohapticError:
        raise
    # An estimator that can't be pickled may raise any exception.
    except Exception as error:
        raise RecognitionError(
            f"{short(estimator)} can't be shared between processes: {reason_of(error)}; set n_jobs to 1."
        ) from error


@one_thread()
def _test_split(prepared: Prepared, split: Split, seed: int, estimator_text: str) -> _SplitTest:
    """Fit and test a copy of the classifier on one split; `estimator_text` names the classifier in errors."""
    pipeline, sequences = prepared.pipeline, prepared.sequences
    generator = spawn_generator(seed, "recognition", pipeline.name, split.repeat, split.number)
    labels, owners = sequences.labels[split.train], sequences.object_index[split.train]
    train = prepared.rows[split.train]
    started = _clock()
    try:
        preparation = seeded(clone(pipeline.preparation), generator)
        train = fit_preparation(preparation, train)
        ((name, own_seed),) = pipeline.seeds(generator).items()
        model = _seeded_deeply(clone(pipeline.classifiers[name]), own_seed)
        routed = _routes_groups(model)
        groups = {"groups": owners} if routed or _takes_groups(model) else {}
        with config_context(enable_metadata_routing=routed or get_config()[_ROUTING]):
            model.fit(train, labels, **groups)
        fitted = _clock()
        predicted = model.predict(preparation.transform(prepared.rows[split.test]))
    except VisuohapticError:
        raise
    # An estimator may raise any exception.
    except Exception as error:
        raise RecognitionError(
            f"{estimator_text} can't be fitted or tested on {_describe_rows(train)}: {reason_of(error)}."
        ) from error
    ended = _clock()
    labels_of_test = _check_labels(predicted, split, len(sequences.classes), estimator_text)
    note = getattr(model, "note_", None)
    return _SplitTest(
        SplitPrediction(split, name, labels_of_test, None, note),
        _difference(started, fitted),
        _difference(fitted, ended),
    )


def _takes_groups(model: Any) -> bool:
    """Return whether `fit` takes the objects of sequences: as an argument, or for the splitter of a search."""
    if has_fit_parameter(model, "groups"):
        return True
    if not isinstance(model, GridSearchCV | RandomizedSearchCV) or not hasattr(model.cv, "split"):
        return False
    if not hasattr(model.cv, "get_metadata_routing"):
        return True
    # A splitter of scikit-learn that ignores groups would warn.
    return "groups" in model.cv.get_metadata_routing().split.requests


def _routes_groups(model: Any) -> bool:
    """Return whether scikit-learn's metadata routing leads `groups` to a splitter within, as in a pipeline with a search."""
    # A search whose estimator has no such splitter takes groups without routing.
    part = getattr(model, "estimator", None) if _takes_groups(model) else model
    if not isinstance(part, BaseEstimator):
        return False
    with config_context(enable_metadata_routing=True):
        try:
            router = get_routing_for_object(part)
        # Estimators without routing raise NotImplementedError; other estimators may raise anything.
        except Exception:  # noqa: BLE001
            return False
        return bool(router.consumes("fit", ["groups"]))


def _seeded_deeply(estimator: Any, seed: int) -> Any:
    """Set `random_state` of an estimator, and of nested estimators and splitters where None; return the estimator."""
    nested = [
        name
        for name, value in estimator.get_params(deep=True).items()
        if name.endswith("__random_state") and value is None
    ]
    if nested:
        estimator.set_params(**dict.fromkeys(nested, seed))
    for splitter in estimator.get_params(deep=True).values():
        if hasattr(splitter, "split") and getattr(splitter, "random_state", 0) is None:
            splitter.random_state = seed  # `clone` has copied the splitter
    return seeded(estimator, seed)


def _check_labels(predicted: Any, split: Split, classes: int, estimator_text: str) -> IntArray:
    """Return predicted labels as integers. Raises `RecognitionError` for a wrong shape, a type other than numbers, or a label that is not in `y`."""
    if fault := masked_fault(predicted):
        raise RecognitionError(f"{estimator_text} predicted labels with {fault}.")
    try:
        labels = np.asarray(predicted)
        allowed = np.isin(labels, np.arange(classes))
    except Exception as error:
        raise RecognitionError(
            f"{estimator_text} predicted labels that can't be read: {reason_of(error)}; one label of y per sequence is "
            "needed."
        ) from error
    if labels.shape == (len(split.test), 1):  # such as predictions of a network
        labels, allowed = labels[:, 0], allowed[:, 0]
    if labels.shape != split.test.shape:
        raise RecognitionError(
            f"{estimator_text} predicted an array of shape {labels.shape} for {len(split.test)} sequences; one label "
            f"per sequence, shape ({len(split.test)},), is needed."
        )
    if not allowed.all():
        raise RecognitionError(
            f"{estimator_text} predicted the label {labels[~allowed][0]!s:.40}; only labels of y, which are 0 to "
            f"{classes - 1}, are allowed."
        )
    is_number = labels.dtype.kind in "iuf" or all(map(is_whole, labels.tolist()))
    if not is_number:
        raise RecognitionError(
            f"{estimator_text} predicted labels of type {labels.dtype}; whole numbers, as in y, are needed."
        )
    return labels.astype(np.int64)


def check_classifier(estimator: Any) -> None:
    """Raise `RecognitionError` unless an object is a classifier that `sklearn.base.clone` can copy.

    An object without scikit-learn's tags is a classifier if it has `get_params`, `fit` and `predict`.
    """
    if isinstance(estimator, type):
        raise RecognitionError(
            f"{estimator.__name__} is a class; an object of it is needed, such as {estimator.__name__}()."
        )
    problem = _why_no_classifier(estimator)
    if problem is not None:
        raise RecognitionError(
            f"{short(estimator)} is {problem}; a scikit-learn classifier is needed."
        )
    _check_clone(estimator)


def _why_no_classifier(estimator: Any) -> str | None:
    """Return the end of the error "It is ...", such as ``without fit``, for no classifier; None for a classifier."""
    for name in ("get_params", "fit"):
        if not hasattr(estimator, name):
            return f"without {name}"
    if not hasattr(estimator, "__sklearn_tags__"):
        return None if hasattr(estimator, "predict") else "without predict"
    try:
        kind = get_tags(estimator).estimator_type
    except Exception as error:
        raise RecognitionError(
            f"{short(estimator)} gives no scikit-learn tags: {reason_of(error)}; a scikit-learn classifier is needed."
        ) from error
    if kind == "classifier":
        return None
    return f"of estimator type {kind}"


def _check_clone(estimator: Any) -> None:
    """Raise `RecognitionError` for an estimator that scikit-learn can't copy, because each split fits a copy."""
    try:
        clone(estimator)
    except Exception as error:
        raise RecognitionError(
            f"{short(estimator)} can't be copied by sklearn.base.clone: {reason_of(error)}; its constructor has to "
            "store each argument, unchanged, under the argument's name."
        ) from error


def _describe_rows(rows: Any) -> str:
    """Return the shape of an array, with the fields of a structured array, for errors."""
    fields = rows.dtype.names
    if not fields:
        return f"rows of shape {rows.shape}"
    named = (f"{name} {rows[name].shape}" for name in fields)
    return f"a structured array of shape {rows.shape} with the fields {', '.join(named)}"


def _clock() -> Seconds:
    """Return the current readings of both clocks; only differences of readings have a meaning."""
    return Seconds(time.process_time(), time.perf_counter())


def _difference(start: Seconds, end: Seconds) -> Seconds:
    return Seconds(end.processor - start.processor, end.wall - start.wall)


def _take_strategy_rows(table: pa.Table, strategy: str, touches: int | None) -> pa.Table:
    """Return rows as `take_strategy`, with list columns; with `touches` None, sequences as long as the longest."""
    # pyarrow can't join tables with list columns, so choose row numbers without these columns.
    lists = [field.name for field in table.schema if pa.types.is_list(field.type)]
    numbered = table.drop_columns(lists).append_column("row", [np.arange(len(table))])
    whole, _ = take_strategy(numbered, strategy, touches)
    return table.take(whole.column("row"))


def _note_of_left_out(rows: pa.Table, whole: pa.Table, strategy: str) -> list[str]:
    """Return a note on the classes with fewer than two objects; raise `RecognitionError` if fewer than two are left."""
    by_strategy = rows.filter(pc.equal(rows.column("strategy"), strategy))
    kept = whole.column("class").unique().to_pylist()
    left_out = sorted(set(by_strategy.column("class").unique().to_pylist()) - set(kept))
    if not left_out:
        return []
    names = ", ".join(left_out[:_MOST_NAMED]) + ", …" * (len(left_out) > _MOST_NAMED)
    if len(kept) < 2:
        raise RecognitionError(
            f"Only class {kept[0]} has two objects with enough touches by {strategy}; {names} have fewer; at least two "
            "classes with two objects each are needed, because an object trains or is tested."
        )
    plural = "classes" if len(left_out) > 1 else "class"
    return [
        f"{plural} {names} left out: fewer than two objects with enough touches, and an object trains or is tested"
    ]


def _as_table(table: Any, schema: Schema) -> pa.Table:
    """Read a path, or convert a table, to the columns of a schema. Raises `RecognitionError` if this is impossible."""
    read = read_table if isinstance(table, str | Path) else take_table
    try:
        return read(schema, table)
    except TableError as error:
        if sentence := why_no_table(table, schema.name):
            raise RecognitionError(sentence) from error
        raise RecognitionError(f"The {schema.name} can't be used: {error}") from error
