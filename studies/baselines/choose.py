"""Choose the settings of the baselines on objects that no result reports: `python -m baselines.choose RESULTS`.

The rule: the baselines and pipeline `order_free` are tuned on the same 67 objects
(`classifier_settings`), by the highest mean accuracy over fixation and random touches, five touches, in
five folds of whole objects. Of settings within 0.1 points of the highest, the first listed is taken.
"""

from __future__ import annotations

import argparse
import itertools
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import visuohaptic as vh
from baselines.estimators import NearestObject, TouchPerceptron
from classifier_settings.choose import choosing_half, first_near_best
from visuohaptic.meshes.catalogue import models_of_set
from visuohaptic.tables.phases import TOUCHES, of_objects
from visuohaptic.tables.schema import read_table

CHOSEN = Path(__file__).with_name("chosen.json")
STRATEGIES = ("fixation", "random")
FOLDS = 5
LEVEL = 0.001
"""Differences of mean accuracies up to this share do not count."""

GRIDS: Mapping[str, tuple[Any, Mapping[str, Sequence[Any]]]] = {
    "nearest_object": (
        NearestObject,
        {"bandwidth": (0.3, 0.2, 0.4, 0.6), "skin": (0.5, 0.25, 1.0, 0.0)},
    ),
    "touch_perceptron": (TouchPerceptron, {"hidden": ((64,), (256,)), "penalty": (1e-4, 1.0)}),
}
"""Estimators and the settings to try, the simplest first."""


def main() -> None:
    """Print and write the mean accuracy of every setting, and the chosen settings."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, help="folder results/ of a run of set `benchmark`")
    parser.add_argument("--catalogue", type=Path, default=Path("meshes/catalogue.csv"))
    arguments = parser.parse_args()
    half = choosing_half(models_of_set(arguments.catalogue, "outside"))
    touches = of_objects(read_table(TOUCHES, arguments.results / "touches"), half)
    result: dict[str, Any] = {}
    for name, (estimator, grid) in GRIDS.items():
        accuracies = {}
        for values in itertools.product(*grid.values()):
            settings = dict(zip(grid, values, strict=True))
            means = [
                vh.evaluate(
                    estimator(**settings),
                    touches,
                    strategy=strategy,
                    inputs="touches",
                    splits=FOLDS,
                ).accuracy
                for strategy in STRATEGIES
            ]
            mean = sum(means) / len(means)
            accuracies[json.dumps(settings)] = mean
            print(f"{name} {settings}: {100 * mean:.2f} %", flush=True)
        settings = json.loads(first_near_best(accuracies, LEVEL))
        result[name] = {"settings": settings, "accuracy": accuracies}
    CHOSEN.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
