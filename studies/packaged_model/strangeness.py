"""Choose a score by which an object seems to be of no known class: ``python -m packaged_model.strangeness FEATURES``.

strangeness.md beside this file states the rule. `FEATURES` is the folder results/features of a run of set ``all``.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray
from scipy.spatial.distance import cdist
from sklearn.metrics import roc_auc_score
from sklearn.model_selection import StratifiedKFold

from packaged_model.measure import FOLDS, PARAMETERS, SEED, admitted, by_object
from visuohaptic.base.arrays import FloatArray, IntArray
from visuohaptic.evaluation.intervals import SIGNIFICANCE, compare_paired, plain_interval
from visuohaptic.meshes.catalogue import TEST_CLASSES
from visuohaptic.recognition.certainty import fit_reference
from visuohaptic.recognition.descriptors import describe_all
from visuohaptic.recognition.experiment import one_thread
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.recognition.pipelines import (
    fit_calibrated,
    fit_preparation,
    log_probabilities,
    make_order_free,
    pooled_log_probabilities,
)
from visuohaptic.recognition.sequences import gather_pipeline, take_strategy
from visuohaptic.recognition.splits import held_out_folds
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table

GROUPS = 5
"""Groups of classes; each group is left out of training once."""
INNER_FOLDS = 10
"""Folds of training objects that give the scores with which new objects are compared."""
COVERAGE = 0.9
TODAY = "nearest object, by views"
CHOSEN = Path(__file__).with_name("strangeness.json")


@dataclass(frozen=True)
class Touched:
    """Descriptors of views, (s, d), the object of each view, (s,), and the class of each object, (o,)."""

    rows: FloatArray
    owners: IntArray
    classes: NDArray[np.str_]

    def of(self, objects: IntArray) -> Touched:
        """Return the views of some objects."""
        chosen = np.isin(self.owners, objects)
        return Touched(self.rows[chosen], self.owners[chosen], self.classes)


def gather(features: pa.Table) -> Touched:
    """Describe the views by fixation of the admitted objects and of those of the test classes."""
    table, _ = take_strategy(features, "fixation", PARAMETERS.touches)
    objects = by_object(table)
    kept = {*admitted(list(objects)), *(owner for owner in objects if owner[0] in TEST_CLASSES)}
    joined = pa.concat_tables([rows for owner, rows in objects.items() if owner in kept])
    sequences = gather_pipeline(joined, PARAMETERS, "order_free", SEED)
    classes = np.array([category for category, _ in sequences.objects])
    rows = describe_all(sequences, PARAMETERS, SEED)
    return Touched(rows, sequences.object_index, classes)


def score(train: Touched, tested: Touched) -> pd.DataFrame:
    """Return one row per tested object, in order, and one column per score: the higher, the stranger."""
    names, labels = np.unique(train.classes[train.owners], return_inverse=True)
    pipeline = make_order_free()
    preparation = pipeline[:-1]
    prepared = fit_preparation(preparation, train.rows)
    model = fit_calibrated(pipeline[-1], prepared, labels, train.owners)
    rows = preparation.transform(tested.rows)
    logs = log_probabilities(model, rows, len(names))
    objects = np.unique(tested.owners)
    members = tested.owners == objects[:, None]
    means = members @ rows / members.sum(axis=1, keepdims=True)
    pooled = pooled_log_probabilities(logs, members)
    _, index = np.unique(train.owners, return_inverse=True)
    own_means = np.stack(
        [prepared[index == number].mean(axis=0) for number in range(index.max() + 1)]
    )
    by_views = fit_reference(prepared, train.owners)
    of_classes = fit_reference(prepared, labels)
    whole = fit_reference(prepared, np.zeros_like(labels))
    to_classes = cdist(means @ of_classes.whitening, of_classes.centres).min(axis=1)
    to_all = cdist(means @ whole.whitening, whole.centres)[:, 0]
    centred = of_classes.centres - of_classes.centres.mean(axis=0)
    directions = np.linalg.svd(centred, full_matrices=False)[2][: len(names) - 1].T
    discriminant = of_classes.whitening @ directions
    votes = logs.argmax(axis=1)
    agreement = [np.bincount(votes[own], minlength=len(names)).max() / own.sum() for own in members]
    return pd.DataFrame(
        {
            TODAY: by_views.distances(means),
            "largest log probability": -pooled.max(axis=1),
            "nearest object, discriminant's space": cdist(
                means @ discriminant, own_means @ discriminant
            ).min(axis=1),
            "nearest class": to_classes,
            "nearest class, relative to all": to_classes**2 - to_all**2,
            "views that agree": -np.array(agreement),
        },
        index=objects,
    )


def areas(touched: Touched) -> pd.DataFrame:
    """Return the area under the ROC curve of each class left out against held-out known objects: one row per class."""
    known = np.unique(touched.classes[~np.isin(touched.classes, TEST_CLASSES)])
    groups = np.array_split(np.random.default_rng(SEED).permutation(known), GROUPS)
    parts = [areas_of(touched, group, np.setdiff1d(known, group)) for group in groups]
    return pd.concat(parts).sort_index()


def areas_of_test_classes(touched: Touched) -> pd.DataFrame:
    """Return the area under the ROC curve of each test class against held-out known objects: one row per class."""
    is_test = np.isin(touched.classes, TEST_CLASSES)
    strange, known = np.unique(touched.classes[is_test]), np.unique(touched.classes[~is_test])
    return areas_of(touched, strange, known)


def areas_of(touched: Touched, strange: NDArray[np.str_], known: NDArray[np.str_]) -> pd.DataFrame:
    """Return the mean area over the models of `FOLDS` folds of known objects: one row per strange class."""
    others = np.flatnonzero(np.isin(touched.classes, strange))
    found: list[dict[str, Any]] = []
    for train, test in divided(touched, np.flatnonzero(np.isin(touched.classes, known))):
        scores = score(touched.of(train), touched.of(np.concatenate([test, others])))
        held_out = scores[np.isin(scores.index, test)]
        for name in strange:
            of_class = scores[touched.classes[scores.index] == name]
            found.append({"class": name, **area(of_class, held_out)})
    return pd.DataFrame(found).groupby("class").mean()


def divided(touched: Touched, objects: IntArray) -> Iterator[tuple[IntArray, IntArray]]:
    """Yield training and held-out objects per fold."""
    present = objects[np.isin(objects, touched.owners)]
    folds = StratifiedKFold(FOLDS, shuffle=True, random_state=SEED)
    for train, test in folds.split(present, touched.classes[present]):
        yield present[train], present[test]


def area(strange: pd.DataFrame, known: pd.DataFrame) -> dict[str, float]:
    """Return the area under the ROC curve of each score."""
    is_strange = np.repeat([1, 0], [len(strange), len(known)])
    both = pd.concat([strange, known])
    return {str(name): float(roc_auc_score(is_strange, both[name])) for name in both}


def unknown(touched: Touched, names: Sequence[str]) -> pd.DataFrame:
    """Return whether each object is called unknown by some scores: held-out known objects once, others by each model.

    An object is unknown if its conformal p value among the training objects, each scored by a model without its fold, is
    at most 1 - `COVERAGE`.
    """
    known = np.flatnonzero(~np.isin(touched.classes, TEST_CLASSES))
    strange = np.flatnonzero(np.isin(touched.classes, TEST_CLASSES))
    found = []
    for train, test in divided(touched, known):
        learnt = touched.of(train)
        labels = np.unique(learnt.classes[learnt.owners], return_inverse=True)[1]
        inner = held_out_folds(labels, learnt.owners, INNER_FOLDS)
        own = pd.concat(
            [
                score(
                    learnt.of(np.unique(learnt.owners[rest])),
                    learnt.of(np.unique(learnt.owners[held])),
                )
                for rest, held in inner
            ]
        )
        scores = score(learnt, touched.of(np.concatenate([test, strange])))
        p_values = {
            name: (1 + (own[name].to_numpy() >= scores[[name]].to_numpy()).sum(axis=1))
            / (1 + len(own))
            for name in names
        }
        is_unknown = {name: values <= 1 - COVERAGE + 1e-12 for name, values in p_values.items()}
        part = pd.DataFrame(is_unknown, index=scores.index)
        found.append(part.assign(strange=np.isin(part.index, strange)))
    return pd.concat(found)


def choose(by_class: pd.DataFrame) -> str:
    """Return the score, other than `TODAY`, with the largest mean area."""
    return str(by_class.drop(columns=TODAY).mean().idxmax())


def gain_in_area(best: str, by_class: pd.DataFrame) -> dict[str, Any]:
    """Return the mean area of a score minus that of `TODAY`, with its interval for new classes, and the p value."""
    weights = np.ones(len(by_class))
    compared = compare_paired(
        by_class[best].to_numpy(), by_class[TODAY].to_numpy(), weights, IntervalParameters()
    )
    return {"difference": plain_interval(compared.difference), "p_value": compared.p_value}


def main() -> None:
    """Choose a score by the rule, and measure it once on the test classes, beside that of today."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("features", type=Path, help="results/features of a run of set all")
    arguments = parser.parse_args()
    features = read_table(FEATURES, sorted(arguments.features.rglob("*.parquet")))
    touched = gather(features.filter(pc.equal(features["strategy"], "fixation")))
    with one_thread():
        by_class = areas(touched)
        best = choose(by_class)
        gain = gain_in_area(best, by_class)
        of_test_classes = areas_of_test_classes(touched)
        found: dict[str, Any] = {
            "areas": by_class.mean().round(3).to_dict(),
            "best": best,
            "gain": gain,
            "taken": bool(gain["p_value"] < SIGNIFICANCE and gain["difference"]["mean"] > 0),
            "areas of test classes": of_test_classes.mean().round(3).to_dict(),
            "gain on test classes": gain_in_area(best, of_test_classes),
        }
        called = unknown(touched, (TODAY, best))
    shares = called.groupby("strange").mean()
    for is_strange, words in ((True, "test classes"), (False, "known classes")):
        found[words] = {
            "objects": int(called[called["strange"] == is_strange].index.nunique()),
            **shares.loc[is_strange].round(4).to_dict(),
        }
    CHOSEN.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
