"""Both pipelines on set ``all``: whose objects count, and the gains."""

import numpy as np
import pyarrow as pa
import pytest

from learned import all_classes
from learned.study import FRAMES
from packaged_model.measure import LEAST_OBJECTS
from visuohaptic.evaluation.intervals import compare_paired
from visuohaptic.meshes.catalogue import TEST_CLASSES
from visuohaptic.recognition.parameters import IntervalParameters


def test_objects_of_test_classes_of_small_classes_and_of_other_strategies_do_not_count():
    owners = [("mug", f"m{number}") for number in range(LEAST_OBJECTS)]
    of_tests = [(TEST_CLASSES[0], f"t{number}") for number in range(LEAST_OBJECTS)]
    others = [("hat", "h"), *of_tests, ("mug", "by_chance")]
    classes, objects = zip(*owners, *others, strict=True)
    strategies = ["fixation"] * (len(classes) - 1) + ["random"]
    columns = {"class": classes, "object": objects, "strategy": strategies}
    kept = all_classes.admitted_rows(pa.table(columns))
    assert kept["object"].to_pylist() == [name for _, name in owners]


def test_gains_are_of_the_network_over_the_discriminant_object_by_object(monkeypatch):
    def found(features, frame, pipeline, count):
        assert count is None
        gain, seed = {"order_free": (0.0, 0), "learned": (0.25, 1)}[pipeline]
        for number in np.random.default_rng(seed).permutation(8):
            yield f"c{number % 2}/o{number}", number / 16 + gain

    monkeypatch.setattr(all_classes, "accuracies", found)
    equal = compare_paired(np.full(8, 0.25), np.zeros(8), np.ones(8), IntervalParameters())
    by_every_object = (equal.difference.low, equal.difference.high)
    rows = [*all_classes.measure(None)]
    assert [row["frame"] for row in rows] == [*FRAMES]
    for row in rows:
        assert row["objects"] == 8
        assert row["gain"] == pytest.approx(0.25)
        # By other pairs of objects the gains would differ between objects.
        np.testing.assert_allclose(row["intervals"][0], by_every_object)
        assert (row["order_free"], row["learned"]) == pytest.approx((7 / 32, 15 / 32))
