"""Measure pipeline `order_free`, the paper's pipeline and the baselines: `python -m baselines.measure RESULTS SET`.

Writes the accuracies per object to ``kept_SET.json`` beside this file.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

import pyarrow as pa
from pydantic import BaseModel
from sklearn.base import clone

import visuohaptic as vh
from baselines.choose import CHOSEN
from baselines.estimators import NearestObject, TouchPerceptron, twenty_lines
from classifier_settings.choose import choosing_half
from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.evaluation.evaluating import Evaluation
from visuohaptic.evaluation.inputs import Inputs
from visuohaptic.io.checkout import find_commit
from visuohaptic.meshes.catalogue import models_of_set
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.tables.phases import FEATURES, TOUCHES, keys_of
from visuohaptic.tables.schema import read_table

FOLDER = Path(__file__).parent
STRATEGIES = ("fixation", "random", "random_visible")
LENGTHS = (5, 1)
OURS = "order_free"
FEWER_SPLITS = {"paper": 27, "benchmark": 5}
"""Number of splits of the perceptron by set, because a fit takes seconds. All objects of a class are tested equally
often."""


@dataclass(frozen=True)
class Contestant:
    """A classifier to compare.

    Attributes
    ----------
    inputs : {"features", "descriptors", "touches"}
        The classifier's input.
    estimator : object or str
        An unfitted classifier, or the name of a registered classifier.
    splits : mapping of str to int
        The number of splits by set of objects. The default is all splits.
    """

    inputs: Inputs
    estimator: Any
    splits: Mapping[str, int] = field(default_factory=dict)

    def evaluate(self, table: pa.Table, objects: str, strategy: str, touches: int) -> Evaluation:
        """Evaluate on the first `touches` of each sequence; estimators of single touches are fitted on `max(LENGTHS)`.

        Estimators of single touches have a parameter `tested`.
        """
        estimator = self.estimator
        if hasattr(estimator, "tested"):
            estimator = clone(estimator).set_params(tested=touches)
            touches = max(LENGTHS)
        parameters = RecognitionParameters(touches=touches)
        return vh.evaluate(
            estimator,
            table,
            parameters,
            strategy,
            inputs=self.inputs,
            splits=self.splits.get(objects),
        )


class KeptCell(BaseModel):
    """Accuracy and weight per object (None for untested objects), and processor seconds of fit and predict per split.

    `commit` and `date` are those of `KeptBaselines`, unless the cell was measured by itself.
    """

    classifier: str
    strategy: str
    touches: int
    splits: int
    accuracy: tuple[float | None, ...]
    weights: tuple[float | None, ...]
    fit: float
    predict: float
    commit: str | None = None
    date: str | None = None


class KeptBaselines(BaseModel):
    """Measured cells of one set of objects. Settings were chosen on the objects in `choosing`."""

    commit: str
    date: str
    objects: tuple[str, ...]
    choosing: tuple[str, ...]
    cells: tuple[KeptCell, ...]


@cache
def contestants() -> dict[str, Contestant]:
    """Return the classifiers to compare with their chosen settings, first `OURS`."""
    chosen = json.loads(CHOSEN.read_text(encoding="utf-8"))
    nearest = NearestObject(**chosen["nearest_object"]["settings"])
    perceptron = TouchPerceptron(**chosen["touch_perceptron"]["settings"])
    return {
        OURS: Contestant("descriptors", "linear_discriminant"),
        "paper": Contestant("features", "support_vector_machine"),
        "nearest_object": Contestant("touches", nearest),
        "touch_perceptron": Contestant("touches", perceptron, FEWER_SPLITS),
        "twenty_lines": Contestant("touches", twenty_lines()),
    }


def measure(
    features: pa.Table,
    touches: pa.Table,
    objects: Sequence[str],
    name_of_set: str,
    classifiers: Sequence[str],
) -> Iterator[KeptCell]:
    """Evaluate classifiers on a run's tables, by every strategy of the run and number of touches, and yield the cells."""
    strategies = set(features.column("strategy").unique().to_pylist())
    for name in classifiers:
        contestant = contestants()[name]
        table = touches if contestant.inputs == "touches" else features
        for strategy in filter(strategies.__contains__, STRATEGIES):
            for length in LENGTHS:
                evaluation = contestant.evaluate(table, name_of_set, strategy, length)
                print(f"{name} {strategy} {length}: {evaluation}", flush=True)
                yield KeptCell(
                    classifier=name,
                    strategy=strategy,
                    touches=length,
                    splits=evaluation.splits,
                    accuracy=tuple(evaluation.by_object.get(key) for key in objects),
                    weights=tuple(evaluation.weights.get(key) for key in objects),
                    fit=evaluation.fit.processor / evaluation.splits,
                    predict=evaluation.predict.processor / evaluation.splits,
                )


def read_kept(name: str) -> KeptBaselines:
    """Read the kept cells of a set of objects."""
    text = (FOLDER / f"kept_{name}.json").read_text(encoding="utf-8")
    return KeptBaselines.model_validate_json(text)


def main() -> None:
    """Measure all cells of a run, or those of one classifier, and write the file after each cell."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, help="folder results/ of a run with three strategies")
    parser.add_argument("set", choices=("paper", "benchmark"))
    parser.add_argument("--catalogue", type=Path, default=Path("meshes/catalogue.csv"))
    parser.add_argument(
        "--only",
        choices=contestants(),
        help="replace only the cells of this classifier, which then have their own commit and date",
    )
    arguments = parser.parse_args()
    features = read_table(FEATURES, arguments.results / "features")
    touches = read_table(TOUCHES, arguments.results / "touches")
    objects = sorted(set(keys_of(features).to_pylist()))
    half = choosing_half(models_of_set(arguments.catalogue, "outside"))
    state = {"commit": find_commit(), "date": datetime.now(UTC).strftime("%Y-%m-%d")}
    if arguments.only:
        kept = read_kept(arguments.set)
        others = tuple(cell for cell in kept.cells if cell.classifier != arguments.only)
        kept = kept.model_copy(update={"cells": others})
    else:
        kept = KeptBaselines(
            **state,
            objects=tuple(objects),
            choosing=tuple(sorted(half.intersection(objects))),
            cells=(),
        )
    classifiers = [arguments.only] if arguments.only else list(contestants())
    for cell in measure(features, touches, kept.objects, arguments.set, classifiers):
        own = cell.model_copy(update=state) if arguments.only else cell
        kept = kept.model_copy(update={"cells": (*kept.cells, own)})
        text = kept.model_dump_json().replace(',"commit":null,"date":null}', "}")
        lines = f"{text}\n".replace('{"classifier"', '\n{"classifier"')
        atomic_write_text(FOLDER / f"kept_{arguments.set}.json", lines)


if __name__ == "__main__":
    main()
