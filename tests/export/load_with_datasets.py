"""Read an export as its users do: `python tests/export/load_with_datasets.py FOLDER`.

It needs `pip install datasets mlcroissant`, which this project does not, and is no test of the suite.
"""

import sys
import tempfile
from pathlib import Path

import mlcroissant
import numpy as np
from datasets import load_dataset
from sklearn.svm import SVC

import visuohaptic as vh

folder = sys.argv[1]
with tempfile.TemporaryDirectory() as cache:
    for name in ("default", "lite"):
        splits = load_dataset(folder, name, cache_dir=cache)
        row = splits["test"][0]
        assert row["image"].size == (32, 32)
        assert splits["test"].features["label"].int2str(row["label"]) == row["class"]
        train, test = (
            set(zip(splits[split]["class"], splits[split]["object"], strict=True))
            for split in ("train", "test")
        )
        assert train
        assert test
        assert not train & test
        sys.stdout.write(f"{name}: {splits.num_rows}, {len(train)} and {len(test)} objects\n")
    first = load_dataset(folder, cache_dir=cache)["train"].with_format("numpy")[:9]
    assert np.abs(255 * first["imprint"] - np.stack(first["image"])).max() <= 0.5001
    features = load_dataset(folder, "features", cache_dir=cache)["all"].to_pandas()
    sys.stdout.write(f"{vh.evaluate(SVC(), features, seed=2018)}\n")
croissant = mlcroissant.Dataset(jsonld=str(Path(folder) / "croissant.json"))
assert next(iter(croissant.records("lite_test")))["lite_test/image"].size == (32, 32)
row = next(iter(croissant.records("default_test")))
assert (
    np.abs(255 * np.array(row["default_test/imprint"]) - row["default_test/image"]).max() <= 0.5001
)
