"""Nothing that is fitted or chosen has seen a test object."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from recognition.synthetic import PAPER_FEATURES, features_table
from sklearn.pipeline import Pipeline

from visuohaptic.recognition.classifiers import CLASSIFIERS
from visuohaptic.recognition.encoding import SequenceEncoder
from visuohaptic.recognition.experiment import predict_splits
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.pipelines import pipeline_of
from visuohaptic.recognition.sequences import gather_sequences
from visuohaptic.recognition.splits import draw_splits

PARAMETERS = RecognitionParameters()
SEQUENCES = gather_sequences(features_table(separation=2.0), PAPER_FEATURES, 5)
SPLITS = draw_splits(SEQUENCES, PARAMETERS.protocol, 0)[::27]


CLASSIFYING = [
    type(CLASSIFIERS[name].make(PARAMETERS.classifier))
    for name in PARAMETERS.order_free.classifiers
]
FITTING = [
    (SequenceEncoder, "fit_transform"),
    *((kind, "fit") for kind in (Pipeline, *CLASSIFYING)),
]


def changed(split, change):
    """The sequences with other test features."""
    values = SEQUENCES.features.copy()
    values[split.test] = change(values[split.test])
    return replace(SEQUENCES, features=values)


def relabelled(split):
    """The sequences with the test objects in other classes."""
    objects = list(SEQUENCES.objects)
    tested = np.unique(SEQUENCES.object_index[split.test])
    for place, other in zip(tested, np.roll(tested, -1), strict=True):
        objects[place] = SEQUENCES.objects[other]
    return replace(SEQUENCES, objects=tuple(objects))


def everything_fitted(pipeline, sequences, split, monkeypatch):
    """Run one split and catch every fitted thing's arrays as they come."""
    caught = []

    def catching(function):
        def wrapper(*values):
            result = function(*values)
            caught.extend(arrays_of(values[0]))
            return result

        return wrapper

    with monkeypatch.context() as patch:
        for kind, name in FITTING:
            patch.setattr(kind, name, catching(getattr(kind, name)))
        list(predict_splits(sequences, pipeline_of(pipeline, PARAMETERS, 6), [split], 6))
    return caught


def arrays_of(thing, depth=0):
    """Every array and number that hangs on a fitted thing."""
    if isinstance(thing, np.ndarray | int | float | str):
        return [np.asarray(thing)]
    if isinstance(thing, list | tuple):
        return [array for part in thing for array in arrays_of(part, depth)]
    if type(thing).__name__ == "Tree":
        return [np.asarray(thing.threshold), np.asarray(thing.feature), np.asarray(thing.value)]
    if depth < 3 and hasattr(thing, "__dict__"):
        return [array for part in vars(thing).values() for array in arrays_of(part, depth + 1)]
    return []


def same(first, second):
    return len(first) == len(second) and all(
        a.dtype == b.dtype and np.array_equal(a, b) for a, b in zip(first, second, strict=True)
    )


CHANGES = {
    "test labels shuffled": relabelled,
    "test data shuffled": lambda split: changed(split, lambda values: values[::-1]),
    "test data replaced": lambda split: changed(split, np.ones_like),
    "test data huge": lambda split: changed(split, lambda values: 1e6 * values),
}
CASES = [
    pytest.param(*case, marks=pytest.mark.slow if place else ())
    for place, case in enumerate(itertools.product(["paper", "order_free"], CHANGES, SPLITS))
]


@pytest.mark.parametrize(("pipeline", "change", "split"), CASES)
def test_other_test_objects_change_nothing_that_is_fitted(pipeline, change, split, monkeypatch):
    before = everything_fitted(pipeline, SEQUENCES, split, monkeypatch)
    after = everything_fitted(pipeline, CHANGES[change](split), split, monkeypatch)
    assert len(before) > 20
    assert same(before, after)


@pytest.mark.slow
@pytest.mark.parametrize("pipeline", ["paper", "order_free"])
def test_one_other_training_touch_changes_what_is_fitted(pipeline, monkeypatch):
    split = SPLITS[0]
    touched = changed(split, lambda values: values)
    touched.features[split.train[0], 0, 0] += 0.5
    before = everything_fitted(pipeline, SEQUENCES, split, monkeypatch)
    assert not same(before, everything_fitted(pipeline, touched, split, monkeypatch))
