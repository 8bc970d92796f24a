"""Measure both pipelines on set ``all`` by the known part of the pose: ``python -m learned.all_classes FEATURES``.

`FEATURES` is the folder results/features of a run of set ``all`` by the strategies of study `learned`. Measured are the
objects of the package's model; by each strategy, objects that have a view with five touches. Each object is tested once,
from one view, by a model that did not learn the object. No question was written down before the figures were computed.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc
from tqdm import tqdm

from learned.curves import accuracies
from learned.study import FRAMES, PIPELINES, STRATEGIES, TOUCHES
from packaged_model.measure import admitted, by_object
from visuohaptic.recognition.experiment import one_thread
from visuohaptic.studies.keeping import write_measured
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table


def admitted_rows(features: pa.Table) -> pa.Table:
    """Return the rows by the study's strategies of the objects that the package's model learns."""
    objects = by_object(features.filter(pc.is_in(features["strategy"], pa.array(STRATEGIES))))
    return pa.concat_tables([objects[owner] for owner in admitted(list(objects))])


def measure(features: pa.Table) -> Iterator[dict[str, Any]]:
    """Yield a row per frame, strategy, pipeline and object, with the columns of `learned.accuracies.arrange`."""
    settings = [*product(FRAMES, STRATEGIES, PIPELINES)]
    for frame, strategy, pipeline in tqdm(settings, unit="setting"):
        for name, accuracy in accuracies(features, strategy, frame, pipeline):
            yield {
                "turns": "none",
                "frame": frame,
                "touches": max(TOUCHES),
                "views": 1,
                "pipeline": pipeline,
                "strategy": strategy,
                "object": name,
                "accuracy": accuracy,
                "weight": 1.0,
            }


def main() -> None:
    """Write the accuracies as Parquet."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("features", type=Path, help="results/features of a run of set all")
    parser.add_argument("--output", type=Path, default=Path("results/learned_all.parquet"))
    arguments = parser.parse_args()
    features = read_table(FEATURES, sorted(arguments.features.rglob("*.parquet")))
    with one_thread():
        table = pa.Table.from_pylist([*measure(admitted_rows(features))])
    write_measured(table, "all", arguments.output)


if __name__ == "__main__":
    main()
