"""Measure both pipelines on set ``all`` by the known part of the pose: ``python -m learned.all_classes FEATURES``.

`FEATURES` is the folder results/features of a run of set ``all``. Measured are the objects of the package's model, of 20
classes, if a view has five touches. Each object is tested once, from one view by fixation, by a model that did not learn
the object. 67 of these objects chose the settings of both pipelines. No question was written down before the figures were
computed.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from learned.curves import accuracies
from learned.study import FRAMES, PIPELINES, STRATEGIES
from packaged_model.measure import admitted, by_object
from visuohaptic.evaluation.intervals import compare_paired
from visuohaptic.recognition.experiment import one_thread
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table

MEASURED = Path(__file__).with_name("all_classes.json")


def admitted_rows(features: pa.Table) -> pa.Table:
    """Return the rows by fixation of the objects that the package's model learns."""
    objects = by_object(features.filter(pc.equal(features["strategy"], STRATEGIES[0])))
    return pa.concat_tables([objects[owner] for owner in admitted(list(objects))])


def measure(features: pa.Table) -> Iterator[dict[str, Any]]:
    """Yield a row per frame: accuracies of both pipelines, and the gain with its intervals for new objects and classes."""
    for frame in FRAMES:
        by_pipeline = [dict(accuracies(features, frame, name, None)) for name in PIPELINES]
        objects = sorted(by_pipeline[0])
        before, after = (np.array([found[key] for key in objects]) for found in by_pipeline)
        classes = [key.split("/")[0] for key in objects]
        compared = compare_paired(
            after, before, np.ones(len(objects)), IntervalParameters(), classes
        )
        intervals = compared.difference, compared.difference_new_classes
        yield {
            "frame": frame,
            "objects": len(objects),
            **dict(zip(PIPELINES, (before.mean(), after.mean()), strict=True)),
            "gain": compared.difference.mean,
            "intervals": [[one.low, one.high] for one in intervals],
        }


def main() -> None:
    """Write the accuracies and gains as JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("features", type=Path, help="results/features of a run of set all")
    arguments = parser.parse_args()
    features = read_table(FEATURES, sorted(arguments.features.rglob("*.parquet")))
    with one_thread():
        rows = [*measure(admitted_rows(features))]
    MEASURED.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
