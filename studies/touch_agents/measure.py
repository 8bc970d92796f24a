"""Measure accuracy and loss after each touch, by chooser of touches and by frame: `python -m touch_agents.measure FILE`.

`make keep STUDY=touch_agents FILE=FILE` keeps the figures. The choosers are strategies and a policy of the experiment, with the touches that they make in the environment. The eyes
are pipeline `order_free`, trained in each split on touches of the same chooser on other objects.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.evaluation.intervals import (
    DIFFERENCE,
    SHARE,
    UNBOUNDED,
    Bounds,
    class_interval,
    compare_differences,
    object_interval,
    plain_comparison,
    plain_interval,
)
from visuohaptic.evaluation.metrics import round_numbers
from visuohaptic.exploration.exploring import TouchableObject, load
from visuohaptic.parameters import ExperimentParameters, as_parameters
from visuohaptic.recognition.experiment import predict_splits
from visuohaptic.recognition.pipelines import pipeline_of
from visuohaptic.recognition.sequences import gather_pipeline
from visuohaptic.recognition.splits import draw_splits
from visuohaptic.studies.conditions import FIXATION_ONLY

CHOOSERS = ("random", "random_visible", "fixation", "seek_relief")
FRAMES = ("full", "vertical", "centre", "none")
TOUCHES = (1, 2, 3, 5, 8)
MESHES = Path(__file__).parents[2] / "meshes/paper"


def main() -> None:
    """Measure, and write the figures as JSON to the file that the command names."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("output", type=Path, help="such as results/touch_agents.json")
    output = parser.parse_args().output
    objects = [load(path) for path in sorted(MESHES.glob("*/*.ply.gz"))]
    rows = []
    for row in measure(objects, CHOOSERS, FRAMES, TOUCHES):
        rows.append(round_numbers(row))
        print(row["chooser"], row["frame"], row["touches"], row["accuracy"]["objects"], flush=True)
    atomic_write_text(output, json.dumps(rows) + "\n")


def measure(
    objects: Sequence[TouchableObject],
    choosers: Sequence[str],
    frames: Sequence[str],
    touches: Sequence[int],
    parameters: Mapping[str, Any] | None = None,
) -> Iterator[dict[str, Any]]:
    """Yield one row per frame, chooser and number of touches; leads are over ``random``, paired by object.

    Each row has ``accuracy`` and ``loss`` with intervals of new objects and of new classes. The loss is the cross
    entropy divided by that of a blind guess, as in the environment. `choosers` begin with ``random``.
    """
    values = {**FIXATION_ONLY, "attention.fixations": max(touches), **(parameters or {})}
    shared = as_parameters({**values, "probing.when_exhausted": "begin_again"})
    features = {name: _features(objects, name, shared) for name in choosers}
    for frame in frames:
        at_random: dict[int, tuple[FloatArray, FloatArray]] = {}
        for name in choosers:
            for count in touches:
                run = _with(shared, frame, count)
                keys, correct, losses = score(features[name], run)
                accuracy_at_random, loss_at_random = at_random.setdefault(count, (correct, losses))
                row: dict[str, Any] = {"chooser": name, "frame": frame, "touches": count}
                row["accuracy"] = _intervals(correct, keys, run, SHARE)
                row["loss"] = _intervals(losses, keys, run, (0.0, math.inf))
                if name != "random":
                    gained, saved = correct - accuracy_at_random, losses - loss_at_random
                    row["accuracy lead"] = _lead(gained, keys, run, DIFFERENCE)
                    row["loss lead"] = _lead(saved, keys, run, UNBOUNDED)
                yield row


def score(
    features: pa.Table, run: ExperimentParameters
) -> tuple[list[str], FloatArray, FloatArray]:
    """Return keys (o,), share of correct answers (o,) and mean loss (o,) per object, over all splits."""
    sequences = gather_pipeline(features, run.recognition, "order_free", run.seed)
    pipeline = pipeline_of("order_free", run.recognition, run.seed)
    splits = draw_splits(sequences, run.recognition.protocol, run.seed)
    correct, losses = (np.zeros(len(sequences.objects)) for _ in range(2))
    counts = np.zeros(len(sequences.objects))
    for one in predict_splits(sequences, pipeline, splits, run.seed):
        test = one.split.test
        labels, owners = sequences.labels[test], sequences.object_index[test]
        if one.log_probabilities is None:
            raise TypeError(f"{one.classifier} has no probabilities; the loss needs them.")
        logs = one.log_probabilities[np.arange(len(test)), labels]
        np.add.at(correct, owners, one.predicted == labels)
        np.add.at(losses, owners, -logs / math.log(len(sequences.classes)))
        np.add.at(counts, owners, 1)
    keys = ["/".join(owner) for owner in sequences.objects]
    return keys, correct / counts, losses / counts


def _features(
    objects: Sequence[TouchableObject], chooser: str, parameters: ExperimentParameters
) -> pa.Table:
    touched = (one.touch(strategy=chooser, parameters=parameters) for one in objects)
    return pa.concat_tables(one.features for one in touched)


def _with(parameters: ExperimentParameters, frame: str, touches: int) -> ExperimentParameters:
    values = parameters.model_dump(exclude_unset=True)
    chosen = {"frame": frame, "touches": touches}
    return as_parameters({**values, "recognition": {**values["recognition"], **chosen}})


def _intervals(
    values: FloatArray, keys: Sequence[str], run: ExperimentParameters, bounds: Bounds
) -> dict[str, Any]:
    weights, intervals = np.ones(len(values)), run.recognition.intervals
    classes = [key.partition("/")[0] for key in keys]
    return {
        "objects": plain_interval(object_interval(values, weights, intervals, bounds)),
        "classes": plain_interval(class_interval(values, weights, classes, intervals, bounds)),
    }


def _lead(
    differences: FloatArray, keys: Sequence[str], run: ExperimentParameters, bounds: Bounds
) -> dict[str, Any]:
    classes = [key.partition("/")[0] for key in keys]
    weights, intervals = np.ones(len(differences)), run.recognition.intervals
    return plain_comparison(
        compare_differences(differences, weights, intervals, bounds=bounds, classes=classes)
    )


if __name__ == "__main__":
    main()
