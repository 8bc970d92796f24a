"""Choose the settings of the baselines on the objects that report nothing: `python -m baselines.choose RESULTS`.

README.md beside this file states the rule.
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
from classifier_settings.choose import choosing_half
from visuohaptic.meshes.catalogue import models_of_set
from visuohaptic.tables.phases import TOUCHES, of_objects
from visuohaptic.tables.schema import read_table

CHOSEN = Path(__file__).with_name("chosen.json")
STRATEGIES = ("fixation", "random")
FOLDS = 5
LEVEL = 0.001
"""Settings whose mean accuracies differ by less count as equal."""

GRIDS: Mapping[str, tuple[Any, Mapping[str, Sequence[Any]]]] = {
    "nearest_object": (
        NearestObject,
        {"bandwidth": (0.3, 0.2, 0.4, 0.6), "skin": (0.5, 0.25, 1.0, 0.0)},
    ),
    "touch_perceptron": (TouchPerceptron, {"hidden": ((64,), (256,)), "penalty": (1e-4, 1.0)}),
}
"""Estimators and the settings to try, the simplest first."""


def chosen_of(accuracies: Mapping[str, float]) -> str:
    """Return the first setting whose mean accuracy is at most `LEVEL` below the highest."""
    best = max(accuracies.values())
    return next(name for name, mean in accuracies.items() if mean >= best - LEVEL)


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
            own = dict(zip(grid, values, strict=True))
            means = [
                vh.evaluate(
                    estimator(**own), touches, strategy=one, inputs="touches", splits=FOLDS
                ).accuracy
                for one in STRATEGIES
            ]
            accuracies[json.dumps(own)] = sum(means) / len(means)
            print(f"{name} {own}: {100 * accuracies[json.dumps(own)]:.2f} %", flush=True)
        settings = json.loads(chosen_of(accuracies))
        result[name] = {"settings": settings, "accuracy": accuracies}
    CHOSEN.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
