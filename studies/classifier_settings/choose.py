"""Choose the settings and the headline classifier of pipeline `order_free`: `python -m classifier_settings.choose`.

README.md beside this file states the rule. It was written before any score was computed.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from sklearn.decomposition import PCA
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.linear_model import LogisticRegression
from sklearn.model_selection import GridSearchCV, StratifiedGroupKFold
from sklearn.naive_bayes import GaussianNB
from sklearn.neighbors import KNeighborsClassifier
from sklearn.pipeline import Pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC
from sklearn.tree import DecisionTreeClassifier

from visuohaptic.meshes.catalogue import Model, models_of_set
from visuohaptic.recognition.descriptors import touch_descriptors
from visuohaptic.recognition.quadratic_discriminant import QuadraticDiscriminant
from visuohaptic.recognition.sequences import take_strategy
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table

HALVES_SEED = 5
ROUNDS = 3
FOLDS = 5
TOUCHES = 5
STRATEGIES = ("fixation", "random")
ROTATIONS = ("passthrough", PCA(svd_solver="full"))

GRIDS: Mapping[str, tuple[Any, Mapping[str, Sequence[Any]]]] = {
    "k_nearest_neighbours": (KNeighborsClassifier(), {"n_neighbors": (5, 1, 15)}),
    "support_vector_machine": (SVC(), {"C": (1.0, 10.0, 100.0)}),
    "decision_tree": (DecisionTreeClassifier(random_state=0), {"min_samples_leaf": (1, 8)}),
    "quadratic_discriminant": (
        QuadraticDiscriminant(regularisation="always", target="mean_variance"),
        {"shrinkage": (0.9, 0.6, 0.3)},
    ),
    "naive_bayes": (GaussianNB(), {"var_smoothing": (1e-9, 0.01, 0.1)}),
    "linear_discriminant": (
        LinearDiscriminantAnalysis(solver="lsqr"),
        {"shrinkage": ("auto", 0.1, 0.5)},
    ),
    "logistic_regression": (LogisticRegression(max_iter=1000), {"C": (0.03, 0.3, 1.0)}),
}
"""Unfitted classifiers, and the values of each setting; the simplest value or the library's default comes first."""


def choosing_half(models: Sequence[Model], seed: int = HALVES_SEED) -> set[str]:
    """Return the objects, ``class/name``, on which settings are chosen: a random half of each class."""
    generator = np.random.default_rng(seed)
    chosen: set[str] = set()
    for category in sorted({model.category for model in models}):
        names = sorted(model.key for model in models if model.category == category)
        chosen.update(generator.permutation(names)[::2].tolist())
    return chosen


def first_near_best(accuracies: Mapping[str, float], margin: float) -> str:
    """Return the first name whose accuracy is at most `margin` below the highest accuracy."""
    best = max(accuracies.values())
    return next(name for name, accuracy in accuracies.items() if accuracy >= best - margin)


def scores_of(
    estimator: Any,
    grid: Mapping[str, Sequence[Any]],
    tables: Sequence[pa.Table],
) -> Iterator[tuple[str, float]]:
    """Yield each setting and its mean accuracy over tables, rounds and folds of whole objects.

    Parameters
    ----------
    estimator : object
        An unfitted classifier.
    grid : mapping of str to sequence
        Values by parameter of the classifier.
    tables : sequence of pyarrow.Table
        Rows of `tables.FEATURES`, one table per strategy.
    """
    steps = [
        ("scaling", StandardScaler()),
        ("rotation", "passthrough"),
        ("classifier", estimator),
    ]
    settings = {f"classifier__{name}": values for name, values in grid.items()}
    means = []
    for table in tables:
        rows, classes, objects = touch_descriptors(table)
        for round_number in range(ROUNDS):
            folds = StratifiedGroupKFold(FOLDS, shuffle=True, random_state=round_number)
            search = GridSearchCV(
                Pipeline(steps), {"rotation": ROTATIONS, **settings}, cv=folds, refit=False
            ).fit(rows, classes, groups=objects)
            means.append(search.cv_results_["mean_test_score"])
    for setting, score in zip(search.cv_results_["params"], np.mean(means, axis=0), strict=True):
        yield ", ".join(f"{name} {value}" for name, value in setting.items()), float(score)


def main() -> None:
    """Print and write the mean accuracy of every setting on the objects of `choosing_half`."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, help="folder results/ of a run of set `benchmark`")
    parser.add_argument("--catalogue", type=Path, default=Path("meshes/catalogue.csv"))
    parser.add_argument("--output", type=Path, default=Path("chosen_settings.json"))
    arguments = parser.parse_args()
    half = choosing_half(models_of_set(arguments.catalogue, "outside"))
    files = sorted((arguments.results / "features").glob("**/*.parquet"))
    features = read_table(FEATURES, files)
    keys = pc.binary_join_element_wise(features["class"], features["object"], "/")
    features = features.filter(pc.is_in(keys, value_set=pa.array(sorted(half))))
    tables = [take_strategy(features, name, TOUCHES)[0] for name in STRATEGIES]
    scores = {}
    for name, (estimator, grid) in GRIDS.items():
        scores[name] = dict(scores_of(estimator, grid, tables))
        for setting, score in scores[name].items():
            print(f"{name}: {setting}: {100 * score:.2f} %", flush=True)
    result = {"half": sorted(half), "accuracy": scores}
    arguments.output.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
