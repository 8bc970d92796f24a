"""Measure accuracy and loss after each touch, by chooser, predictor and frame: `python -m touch_agents.measure MESHES SET FILE`.

MESHES is the folder ``results/meshes`` of a run of the set. `make keep STUDY=touch_agents/baselines SET=SET FILE=FILE`
keeps the figures. The rule, written before the figures of the chooser `adaptive` and of the predictor `learned` were
computed:

1. Questions. Which chooser that does not learn by trial is ahead of random places in reach? Does the network of touches,
   `learned`, know more from the same touches than `order_free`?
2. Choosers:

   - random, in reach: places uniform by area over the whole surface (`random`, draw 0);
   - random, in sight: places uniform by area over the visible surface (`random_visible`);
   - fixations in order: the fixations of the attention model (`fixation`);
   - `seek_relief`: visible places by the relief of earlier touches (docs/policies.md);
   - `adaptive`: visible places by their expected information, learnt per split from training objects (study touch_curves).

3. Predictors. Pipelines `order_free` and `learned`, with the parameters of a default run, trained in each split on touches
   of the same chooser on other objects. In each frame they do not use the unknown part of the pose.
4. Objects. Two sets, judged apart. The paper's twelve objects: 16 viewpoints, three folds of whole objects, each object
   tested once. Set benchmark, 142 objects: the split of learning.py. The 67 objects on which settings of predictors were
   chosen train, the other 75 are tested once, from eight viewpoints.
5. Measure. For each tested object the share of correct answers, and the mean loss, after 1, 2, 3 and 5 touches, as an
   episode has five. Figures per number of touches have intervals of new objects and of new classes, and no test.
6. Tests. The mean over these four numbers of touches, in pairs over objects, by the sign-change test. Per set there are 104
   differences: 32 leads over random places in reach (four choosers, two predictors, four frames) and 20 of `learned` minus
   `order_free` (five choosers, four frames), of accuracy and of loss. Holm's correction covers all 104. A difference is
   shown if its corrected p value is below 0.05. Twelve objects have 4,096 sign changes, so that no p value is below
   1/2,048: after the correction they can show nothing.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pyarrow as pa

from classifier_settings.half import choosing_objects
from touch_agents.candidates import VIEWPOINTS
from touch_agents.learning import SHOWN
from touch_curves.adaptive import ChosenTouches, choose_touches, predict_chosen, touch_candidates
from touch_curves.choosing import ADAPTIVE
from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.base.errors import RecognitionError
from visuohaptic.evaluation.intervals import (
    DIFFERENCE,
    SHARE,
    UNBOUNDED,
    Bounds,
    class_interval,
    compare_differences,
    holm,
    object_interval,
    plain_comparison,
    plain_interval,
)
from visuohaptic.evaluation.metrics import round_numbers
from visuohaptic.evaluation.summary import select
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import object_of, usable_meshes
from visuohaptic.parameters import ExperimentParameters, as_parameters
from visuohaptic.pipeline import run as run_phases
from visuohaptic.recognition.experiment import one_thread
from visuohaptic.recognition.parameters import Frame, IntervalParameters
from visuohaptic.recognition.sequences import TouchSequences, gather_pipeline
from visuohaptic.recognition.splits import Split, draw_splits
from visuohaptic.studies.conditions import FIXATION_ONLY
from visuohaptic.studies.measuring import Predictions
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table, write_table

STRATEGIES = ("random", "random_visible", "fixation", "seek_relief")
CHOOSERS = (*STRATEGIES, ADAPTIVE.name)
PREDICTORS = ("order_free", "learned")
FRAMES: tuple[Frame, ...] = ("full", "vertical", "centre", "none")
MEASURES: Mapping[str, tuple[Bounds, Bounds]] = {
    "accuracy": (SHARE, DIFFERENCE),
    "loss": ((0.0, math.inf), UNBOUNDED),
}
"""Bounds of the values and of their differences."""

Draw = Callable[[TouchSequences], list[Split]]
Values = Mapping[str, FloatArray]
"""Mean accuracy and loss of each tested object, by name of the measure, (o,) each."""


@dataclass(frozen=True)
class Cell:
    """A chooser of touches, a predictor, the known part of the frame, and the number of touches."""

    chooser: str
    predictor: str
    frame: Frame
    touches: int


@dataclass(frozen=True)
class SetOfObjects:
    """How a set of objects is seen and divided.

    Attributes
    ----------
    training : collection of str, optional
        The objects that train, ``class/name``; the others are tested. By default each object is tested, in the folds
        of the changed parameters.
    changes : mapping
        Changed parameters by dotted name.
    """

    training: Collection[str] | None = None
    changes: Mapping[str, Any] = field(default_factory=dict)

    def parameters(self) -> ExperimentParameters:
        """Return the parameters of all touches of the set."""
        touching = {
            "probing.strategies": STRATEGIES,
            "probing.random_draws": 1,
            "probing.when_exhausted": "begin_again",
            "attention.fixations": max(SHOWN),
            "recognition.touches": max(SHOWN),
        }
        return as_parameters({**FIXATION_ONLY, **touching, **self.changes})

    def splits(self, sequences: TouchSequences) -> list[Split]:
        """Divide sequences into training and test; raise `RecognitionError` if no object trains."""
        run = self.parameters()
        if self.training is None:
            return draw_splits(sequences, run.recognition.protocol, run.seed)
        trains = np.array(["/".join(owner) in self.training for owner in sequences.objects])
        if not trains.any() or trains.all():
            raise RecognitionError(
                f"{trains.sum()} of {len(trains)} objects train; some of each kind are needed."
            )
        of_sequence = trains[sequences.object_index]
        return [Split(0, 0, np.flatnonzero(of_sequence), np.flatnonzero(~of_sequence))]


def set_of_objects(name: Literal["paper", "benchmark"]) -> SetOfObjects:
    """Return the division of a set by the rule."""
    if name == "benchmark":
        return SetOfObjects(choosing_objects(), {"viewpoints.count": VIEWPOINTS})
    folds = {"protocol": "auto", "maximum_splits": 1, "fold_rounds": 1}
    return SetOfObjects(
        changes={f"recognition.protocol.{key}": value for key, value in folds.items()}
    )


def main() -> None:
    """Measure, and write the figures as JSON to the file that the command names."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("meshes", type=Path, help="such as results/meshes")
    parser.add_argument("set", choices=("paper", "benchmark"), help="the set of these meshes")
    parser.add_argument("output", type=Path, help="such as results/touch_agents.json")
    parser.add_argument("--touches", type=Path, help="folder that keeps the touches")
    arguments = parser.parse_args()
    objects = set_of_objects(arguments.set)
    meshes = usable_meshes(sorted(arguments.meshes.rglob("*.ply")))
    tables = touch_all(meshes, objects.parameters(), arguments.touches)
    chosen = {
        name: choose(name, table, objects.parameters(), objects.splits)
        for name, table in tables.items()
    }
    keys, values = measure(chosen, objects.parameters())
    figures = summarise(keys, values, objects.parameters().recognition.intervals)
    atomic_write_text(arguments.output, json.dumps(round_numbers(figures)) + "\n")


def touch_all(
    meshes: Sequence[str | Path], parameters: ExperimentParameters, folder: Path | None = None
) -> dict[str, pa.Table]:
    """Return `tables.FEATURES` by chooser, for `adaptive` of all its candidates; `folder` keeps the tables."""
    file = None if folder is None else folder / "touches.parquet"
    if file is not None and file.exists():
        table = read_table(FEATURES, file)
    else:
        parts = []
        for mesh in meshes:
            viewpoints = range(parameters.viewpoints.total)
            subject = Subject.of_mesh(object_of(mesh), mesh, viewpoints)
            parts += [
                run_phases(subject, parameters)["features"],
                touch_candidates(subject, parameters),
            ]
        table = pa.concat_tables(parts)
        if file is not None:
            file.parent.mkdir(parents=True, exist_ok=True)
            write_table(FEATURES, table, file)
    return {name: select(table, strategy=name) for name in CHOOSERS}


def choose(
    chooser: str, features: pa.Table, parameters: ExperimentParameters, draw: Draw
) -> ChosenTouches:
    """Return the touches of a chooser in each split that `draw` makes; only `adaptive` learns from the split."""
    if chooser == ADAPTIVE.name:
        return choose_touches(ADAPTIVE, features, parameters, max(SHOWN), draw)
    sequences = gather_pipeline(features, parameters.recognition, "order_free", parameters.seed)
    splits = draw(sequences)
    nothing = replace(sequences, features=sequences.features[:, :0])
    first = select(features, touch=0)
    return ChosenTouches(nothing, first, splits, [sequences.features] * len(splits))


def measure(
    chosen: Mapping[str, ChosenTouches],
    parameters: ExperimentParameters,
    predictors: Sequence[str] = PREDICTORS,
    frames: Sequence[Frame] = FRAMES,
    touches: Sequence[int] = SHOWN,
) -> tuple[list[str], dict[Cell, Values]]:
    """Return the tested objects and their values by cell; predictors train on touches of the same chooser.

    The loss is the cross entropy divided by that of a blind guess, as in the environment. Raises `RecognitionError` if
    choosers tested different objects.
    """
    values: dict[Cell, Values] = {}
    tested: list[str] = []
    for frame, predictor, count in product(frames, predictors, touches):
        run = _with(parameters, frame, count)
        for name, of_chooser in chosen.items():
            with one_thread():
                keys, found = score(predict_chosen(of_chooser, run, predictor))
            tested = tested or keys
            if keys != tested:
                raise RecognitionError(
                    f"{name} tested {len(keys)} objects; the same {len(tested)} as by other choosers are needed."
                )
            values[Cell(name, predictor, frame, count)] = found
            means = ", ".join(f"{measure} {mean.mean():.3f}" for measure, mean in found.items())
            print(frame, predictor, count, name, means, flush=True)
    return tested, values


def score(predictions: Predictions) -> tuple[list[str], Values]:
    """Return the tested objects, and their share of correct answers and mean loss over all splits, (o,) each.

    Raises `TypeError` if the classifier has no probabilities.
    """
    sequences = predictions.sequences
    correct, losses, counts = np.zeros((3, len(sequences.objects)))
    for one in predictions.splits:
        test = one.split.test
        labels, owners = sequences.labels[test], sequences.object_index[test]
        if one.log_probabilities is None:
            raise TypeError(f"{one.classifier} has no probabilities; the loss needs them.")
        logs = one.log_probabilities[np.arange(len(test)), labels]
        np.add.at(correct, owners, one.predicted == labels)
        np.add.at(losses, owners, -logs / math.log(len(sequences.classes)))
        np.add.at(counts, owners, 1)
    tested = np.flatnonzero(counts)
    keys = ["/".join(sequences.objects[index]) for index in tested]
    found = {"accuracy": correct, "loss": losses}
    return keys, {name: total[tested] / counts[tested] for name, total in found.items()}


def summarise(
    keys: Sequence[str], values: Mapping[Cell, Values], intervals: IntervalParameters
) -> dict[str, Any]:
    """Compute values with intervals of new objects and of new classes per cell, and the compared differences.

    `keys` and `values` are those of `measure`. Holm's correction covers all differences of both measures.
    """
    weights, classes = np.ones(len(keys)), [key.partition("/")[0] for key in keys]
    cells: list[dict[str, Any]] = []
    for cell, found in values.items():
        row: dict[str, Any] = dict(vars(cell))
        for name, (bounds, _) in MEASURES.items():
            of_objects = object_interval(found[name], weights, intervals, bounds)
            of_classes = class_interval(found[name], weights, classes, intervals, bounds)
            row[name] = {
                "objects": plain_interval(of_objects),
                "classes": plain_interval(of_classes),
            }
        cells.append(row)
    differences: list[dict[str, Any]] = []
    for name, (_, bounds) in MEASURES.items():
        for named, gap in _differences(partial(_mean_over_touches, values, name), values):
            compared = compare_differences(gap, weights, intervals, bounds, classes)
            differences.append({"measure": name, **named, "comparison": plain_comparison(compared)})
    p_values = [row["comparison"]["p_value"] for row in differences]
    for row, corrected in zip(differences, holm(p_values), strict=True):
        row["corrected"] = corrected
    return {"cells": cells, "differences": differences}


def _differences(
    mean_of: Callable[[str, str, str], FloatArray], values: Mapping[Cell, Values]
) -> Iterator[tuple[dict[str, str], FloatArray]]:
    """Yield the names and the values (o,) of each compared difference of the rule."""
    choosers, predictors, frames = (
        list(dict.fromkeys(getattr(cell, name) for cell in values))
        for name in ("chooser", "predictor", "frame")
    )
    reference, *others = choosers
    for frame, predictor, chooser in product(frames, predictors, others):
        gap = mean_of(chooser, predictor, frame) - mean_of(reference, predictor, frame)
        yield {"frame": frame, "predictor": predictor, "chooser": chooser}, gap
    first, *rest = predictors
    for frame, chooser, predictor in product(frames, choosers, rest):
        gap = mean_of(chooser, predictor, frame) - mean_of(chooser, first, frame)
        yield {"frame": frame, "predictor": f"{predictor} - {first}", "chooser": chooser}, gap


def _mean_over_touches(
    values: Mapping[Cell, Values], measure: str, chooser: str, predictor: str, frame: Frame
) -> FloatArray:
    """Return the mean of a measure over the numbers of touches `SHOWN`, (o,)."""
    found = [values[Cell(chooser, predictor, frame, count)][measure] for count in SHOWN]
    mean: FloatArray = np.mean(found, axis=0)
    return mean


def _with(parameters: ExperimentParameters, frame: Frame, touches: int) -> ExperimentParameters:
    values = parameters.model_dump(exclude_unset=True)
    chosen = {"frame": frame, "touches": touches}
    return as_parameters({**values, "recognition": {**values["recognition"], **chosen}})


if __name__ == "__main__":
    main()
