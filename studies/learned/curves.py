"""Measure accuracy by the number of training objects per class: ``python -m learned.curves FEATURES``.

`FEATURES` is the folder results/features of a run of set ``benchmark``. Splits are those of study `learned`, with five
touches by fixation. In each split, so many training objects of each class are drawn; fewer objects are a part of more.
Reported are objects that chose no setting.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from classifier_settings.half import choosing_objects
from learned.study import PIPELINES, STRATEGIES
from visuohaptic.base.arrays import IntArray
from visuohaptic.evaluation.intervals import object_interval
from visuohaptic.recognition.experiment import predict_splits
from visuohaptic.recognition.parameters import (
    Frame,
    IntervalParameters,
    ProtocolParameters,
    RecognitionParameters,
)
from visuohaptic.recognition.pipelines import pipeline_of
from visuohaptic.recognition.sequences import TouchSequences, gather_pipeline, take_strategy
from visuohaptic.recognition.splits import Split, draw_splits
from visuohaptic.studies.conditions import ONE_CLASSIFIER
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table

COUNTS = (2, 4, 8, None)
"""Training objects per class; None for all."""
FRAMES: tuple[Frame, ...] = ("full", "none")
SEED = 2018
MEASURED = Path(__file__).with_name("curves.json")


def parameters_of(frame: Frame) -> RecognitionParameters:
    """Return the parameters of study `learned` for a frame."""
    discriminant = ONE_CLASSIFIER["recognition.order_free.classifiers"]
    return RecognitionParameters(
        frame=frame,
        order_free={"classifiers": discriminant},
        protocol=ProtocolParameters(protocol="grouped_folds"),
    )


def divided(
    features: pa.Table, strategy: str, frame: Frame, pipeline: str
) -> tuple[TouchSequences, list[Split]]:
    """Return the sequences by a strategy, and the splits of study `learned`; each object is tested once."""
    parameters = parameters_of(frame)
    table, _ = take_strategy(features, strategy, parameters.touches)
    sequences = gather_pipeline(table, parameters, pipeline, SEED)
    return sequences, draw_splits(sequences, parameters.protocol, SEED)


def training_objects(sequences: TouchSequences, train: IntArray, count: int | None) -> IntArray:
    """Draw so many training objects of each class; all where a class has fewer."""
    generator = np.random.default_rng(SEED)
    objects = generator.permutation(np.unique(sequences.object_index[train]))
    of_class = sequences.class_of_object[objects]
    chosen = [objects[of_class == label][:count] for label in np.unique(of_class)]
    return np.sort(np.concatenate(chosen))


def accuracies(
    features: pa.Table, strategy: str, frame: Frame, pipeline: str, count: int | None = None
) -> Iterator[tuple[str, float]]:
    """Yield each object, ``class/name``, with the share of its views that is classified right."""
    sequences, splits = divided(features, strategy, frame, pipeline)
    owners = sequences.object_index
    fewer = []
    for split in splits:
        objects = training_objects(sequences, split.train, count)
        fewer.append(replace(split, train=split.train[np.isin(owners[split.train], objects)]))
    parts = pipeline_of(pipeline, parameters_of(frame), SEED)
    for found in predict_splits(sequences, parts, fewer, SEED):
        test = found.split.test
        right = found.predicted == sequences.labels[test]
        for index in np.unique(owners[test]):
            yield "/".join(sequences.objects[index]), float(right[owners[test] == index].mean())


def measure(features: pa.Table) -> Iterator[dict[str, Any]]:
    """Yield one row per frame, pipeline and number of training objects, over objects that chose nothing."""
    for frame, pipeline, count in product(FRAMES, PIPELINES, COUNTS):
        found = dict(accuracies(features, STRATEGIES[0], frame, pipeline, count))
        shares = np.array([found[key] for key in sorted({*found} - choosing_objects())])
        interval = object_interval(shares, np.ones(len(shares)), IntervalParameters())
        yield {
            "frame": frame,
            "pipeline": pipeline,
            "training_objects": "all" if count is None else f"{count} objects",
            "objects": len(shares),
            **{name: round(value, 6) for name, value in vars(interval).items()},
        }


def main() -> None:
    """Write the accuracies as JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("features", type=Path, help="results/features of a run of set benchmark")
    arguments = parser.parse_args()
    features = read_table(FEATURES, sorted(arguments.features.rglob("*.parquet")))
    MEASURED.write_text(json.dumps([*measure(features)], indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
