"""Both pipelines on set ``all``: whose objects count, and the accuracies of each setting."""

from itertools import product
from pathlib import Path

import pandas as pd
import pyarrow as pa

from learned import all_classes
from learned.study import FRAMES, PIPELINES, STRATEGIES
from packaged_model.measure import LEAST_OBJECTS
from visuohaptic.meshes.catalogue import TEST_CLASSES

FOLDER = Path(all_classes.__file__).parent
SETTINGS = [*product(FRAMES, STRATEGIES, PIPELINES)]


def test_objects_of_test_classes_of_small_classes_and_of_other_strategies_do_not_count():
    owners = [("mug", f"m{number}") for number in range(LEAST_OBJECTS)]
    of_tests = [(TEST_CLASSES[0], f"t{number}") for number in range(LEAST_OBJECTS)]
    others = [("hat", "h"), *of_tests, ("mug", "by_no_strategy")]
    classes, objects = zip(*owners, *others, strict=True)
    strategies = [*STRATEGIES, *["fixation"] * (len(classes) - 4), "random_walk"]
    columns = {"class": classes, "object": objects, "strategy": strategies}
    kept = all_classes.admitted_rows(pa.table(columns))
    assert kept["object"].to_pylist() == [name for _, name in owners]


def test_each_setting_has_the_accuracies_of_its_frame_strategy_and_pipeline(monkeypatch):
    def found(features, strategy, frame, pipeline):
        # Each setting has accuracies of its own.
        yield "cup/a", SETTINGS.index((frame, strategy, pipeline)) / 100
        yield "bed/b", 0.5

    monkeypatch.setattr(all_classes, "accuracies", found)
    rows = [*all_classes.measure(None)]
    assert len(rows) == 2 * len(SETTINGS)
    for row in rows:
        setting = (row["frame"], row["strategy"], row["pipeline"])
        expected = SETTINGS.index(setting) / 100 if row["object"] == "cup/a" else 0.5
        assert row["accuracy"] == expected
        assert (row["turns"], row["touches"], row["views"], row["weight"]) == ("none", 5, 1, 1.0)
    assert {*rows[0]} == {*pd.read_parquet(FOLDER / "kept_benchmark.parquet").columns}
