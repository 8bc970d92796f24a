"""Both pipelines on set ``all``: whose objects count, the gains, and the leads of fixation."""

from itertools import product

import numpy as np
import pyarrow as pa
import pytest

from learned import all_classes
from learned.study import FRAMES, PIPELINES, STRATEGIES
from packaged_model.measure import LEAST_OBJECTS
from visuohaptic.evaluation.intervals import compare_paired
from visuohaptic.meshes.catalogue import TEST_CLASSES
from visuohaptic.recognition.parameters import IntervalParameters

OBJECTS = 8


def test_objects_of_test_classes_of_small_classes_and_of_other_strategies_do_not_count():
    owners = [("mug", f"m{number}") for number in range(LEAST_OBJECTS)]
    of_tests = [(TEST_CLASSES[0], f"t{number}") for number in range(LEAST_OBJECTS)]
    others = [("hat", "h"), *of_tests, ("mug", "by_no_strategy")]
    classes, objects = zip(*owners, *others, strict=True)
    strategies = [*STRATEGIES, *["fixation"] * (len(classes) - 4), "random_walk"]
    columns = {"class": classes, "object": objects, "strategy": strategies}
    kept = all_classes.admitted_rows(pa.table(columns))
    assert kept["object"].to_pylist() == [name for _, name in owners]


def test_gains_and_leads_are_compared_object_by_object(monkeypatch):
    of_pipeline, of_strategy = (
        {"order_free": 0.0, "learned": 0.25},
        {"fixation": 0.125, "random_visible": 0.0625},
    )

    def found(features, strategy, frame, pipeline):
        # Objects come in another order each time, and one has no touches by random places in sight.
        seed = [*product(STRATEGIES, PIPELINES)].index((strategy, pipeline))
        for number in np.random.default_rng(seed).permutation(OBJECTS):
            if (strategy, number) != ("random_visible", 0):
                share = number / 16 + of_pipeline[pipeline] + of_strategy.get(strategy, 0.0)
                yield f"c{number % 2}/o{number}", share

    monkeypatch.setattr(all_classes, "accuracies", found)
    measured = all_classes.measure(None)
    settings = [*product(FRAMES, STRATEGIES, PIPELINES)]
    rows = measured["accuracies"]
    assert [(row["frame"], row["strategy"], row["pipeline"]) for row in rows] == settings
    for row in rows:
        hidden = row["strategy"] == "random_visible"
        base = of_pipeline[row["pipeline"]] + of_strategy.get(row["strategy"], 0.0)
        assert row["objects"] == OBJECTS - hidden
        assert row["accuracy"] == pytest.approx(np.arange(hidden, OBJECTS).mean() / 16 + base)
    of_lead = {"seeing": 0.125, "sight": 0.0625, "salience": 0.0625}
    for rows, differences in (
        (measured["gains"], dict.fromkeys(product(FRAMES, STRATEGIES), 0.25)),
        (
            measured["leads"],
            {setting: of_lead[setting[-1]] for setting in product(FRAMES, PIPELINES, of_lead)},
        ),
    ):
        for row, (setting, difference) in zip(rows, differences.items(), strict=True):
            assert (*row.values(),)[: len(setting)] == setting
            count = OBJECTS - (setting[-1] in {"random_visible", "sight", "salience"})
            # By other pairs of objects the differences would differ between objects.
            equal = compare_paired(
                np.full(count, difference), np.zeros(count), np.ones(count), IntervalParameters()
            )
            assert row["objects"] == count
            assert row["classes"] == 2
            assert row["difference"] == pytest.approx(vars(equal.difference))
