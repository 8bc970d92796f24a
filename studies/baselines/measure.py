"""Measure pipeline `order_free`, the paper's pipeline and the baselines: `python -m baselines.measure RESULTS SET`.

Writes the accuracies per object to ``RESULTS/baselines.parquet``.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import pyarrow as pa
from sklearn.base import clone

import visuohaptic as vh
from baselines.choose import CHOSEN
from baselines.estimators import NearestObject, TouchPerceptron, twenty_lines
from classifier_settings.choose import choosing_half
from visuohaptic.evaluation.evaluating import Evaluation
from visuohaptic.evaluation.inputs import Inputs
from visuohaptic.meshes.catalogue import models_of_set
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.studies.figures import rows_by
from visuohaptic.studies.keeping import Source, kept_file, read_source, write_measured
from visuohaptic.tables.phases import FEATURES, TOUCHES, keys_of
from visuohaptic.tables.schema import open_parquet, read_table

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


@dataclass(frozen=True)
class KeptCell:
    """Accuracy and weight per object (None for untested objects), and processor seconds of fit and predict per split."""

    classifier: str
    strategy: str
    touches: int
    splits: int
    fit: float
    predict: float
    accuracy: Sequence[float | None]
    weights: Sequence[float | None]


@dataclass(frozen=True)
class KeptBaselines:
    """Measured cells of one set of objects. Settings were chosen on the objects in `choosing`."""

    source: Source
    objects: Sequence[str]
    choosing: Sequence[str]
    cells: Sequence[KeptCell]


_CELL = ("classifier", "strategy", "touches", "splits", "fit", "predict")


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
) -> Iterator[KeptCell]:
    """Evaluate all classifiers on a run's tables, by every strategy of the run and number of touches."""
    strategies = set(features.column("strategy").unique().to_pylist())
    for name, contestant in contestants().items():
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


def arrange(
    cells: Iterable[KeptCell], objects: Sequence[str], choosing: Collection[str]
) -> pa.Table:
    """Return one row per cell and object. `choosing` are the objects on which settings were chosen."""
    rows = []
    for cell in cells:
        named = {name: value for name, value in asdict(cell).items() if name in _CELL}
        for key, accuracy, weight in zip(objects, cell.accuracy, cell.weights, strict=True):
            owner = {"object": key, "choosing": key in choosing}
            rows.append({**named, **owner, "accuracy": accuracy, "weight": weight})
    return pa.Table.from_pylist(rows)


def read_kept(name: str, folder: Path = FOLDER) -> KeptBaselines:
    """Read the kept cells of a set of objects."""
    path = kept_file(folder, name)
    cells, owners = [], dict[str, bool]()
    for key, rows in rows_by(open_parquet(path).read(), _CELL).items():
        columns = rows.to_pydict()
        owners = dict(zip(columns["object"], columns["choosing"], strict=True))
        named = dict(zip(_CELL, key, strict=True))
        cells.append(KeptCell(**named, accuracy=columns["accuracy"], weights=columns["weight"]))
    choosing = tuple(key for key, chose in owners.items() if chose)
    return KeptBaselines(read_source(path), tuple(owners), choosing, cells)


def main() -> None:
    """Measure all cells of a run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, help="folder results/ of a run with three strategies")
    parser.add_argument("set", choices=("paper", "benchmark"))
    parser.add_argument("--catalogue", type=Path, default=Path("meshes/catalogue.csv"))
    arguments = parser.parse_args()
    features = read_table(FEATURES, arguments.results / "features")
    touches = read_table(TOUCHES, arguments.results / "touches")
    objects = sorted(set(keys_of(features).to_pylist()))
    half = choosing_half(models_of_set(arguments.catalogue, "outside"))
    cells = measure(features, touches, objects, arguments.set)
    table = arrange(cells, objects, half)
    write_measured(table, arguments.set, arguments.results / "baselines.parquet")


if __name__ == "__main__":
    main()
