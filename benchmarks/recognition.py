"""Seconds of training and testing, and the batch map beside MiniSom's own trainings.

Run as ``python benchmarks/recognition.py``. Peers take turns in every round; figures are medians
over the rounds, ratios are medians of ratios within a round.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable

import numpy as np
import pyarrow as pa
import pywt
from minisom import MiniSom
from numpy.typing import NDArray

from benchmarks.turns import Peers, in_turn, medians, ratios
from visuohaptic import recognition
from visuohaptic.recognition.descriptors import describe_sequences, draw_waves
from visuohaptic.recognition.experiment import draw_splits, gather_pipeline
from visuohaptic.recognition.parameters import (
    RecognitionParameters,
    SelfOrganisingMapParameters,
    SequenceParameters,
)
from visuohaptic.recognition.self_organising_map import fit_batch_map, line
from visuohaptic.recognition.sequence_features import wavelet_levels
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import build_table

ROUNDS = 5
PIPELINE_ROUNDS = 3
SVM = "support_vector_machine"


def run() -> dict[str, object]:
    """Measure maps, transforms and whole pipelines.

    ``map`` and ``wavelet``: ``milliseconds`` by peer and ``ratio_to_ours``; ``map`` also
    ``quantisation_error``. ``splits``: processor milliseconds of 81 splits of one strategy of a
    set of the paper's shape, by pipeline, and by plain scikit-learn: the descriptors and the
    support vector machine of pipeline `best`, its penalty chosen by a grid search, without a
    temperature, an answer for several views, or a fit kept for another split.
    """
    touches = np.random.default_rng(0).normal(size=(640, 22))
    maps = _maps(touches)
    table = features_of_the_papers_shape()
    parameters = RecognitionParameters()
    machine = parameters.model_copy(
        update={"best": parameters.best.model_copy(update={"classifiers": (SVM,)})}
    )
    pipelines: Peers = {
        "paper, five classifiers": lambda: recognition.run_pipeline(table, parameters, 1, "paper"),
        "best, six classifiers": lambda: recognition.run_pipeline(table, parameters, 1, "best"),
        "ours": lambda: recognition.run_pipeline(table, machine, 1, "best"),
        "scikit-learn": lambda: plain_scikit_learn(table, machine),
    }
    return {
        "rounds": ROUNDS,
        "map": _compare(maps) | {"quantisation_error": {name: maps[name]() for name in maps}},
        "wavelet": _compare(_transforms()),
        "splits": _compare(pipelines, PIPELINE_ROUNDS),
    }


def _maps(touches: NDArray[np.float64]) -> dict[str, Callable[[], float]]:
    """Give trainings; each reports the mean distance of a touch to its nearest unit."""

    def ours() -> float:
        fitted = fit_batch_map(touches, line(5), SelfOrganisingMapParameters())
        return float(fitted.distances(touches).min(axis=1).mean())

    def minisom(training: str, steps: int) -> Callable[[], float]:
        def train() -> float:
            som = MiniSom(5, 1, touches.shape[1], sigma=2.0, learning_rate=0.5, random_seed=1)
            som.random_weights_init(touches)
            getattr(som, training)(touches, steps)
            return float(som.quantization_error(touches))

        return train

    return {
        "ours": ours,
        "MiniSom batch, 20 passes": minisom("train_batch_offline", 20),
        "MiniSom online, 1 pass": minisom("train_random", len(touches)),
        "MiniSom online, 10 passes": minisom("train_random", 10 * len(touches)),
    }


def _transforms() -> dict[str, Callable[[], object]]:
    signals = np.random.default_rng(1).normal(size=(192, 5, 5))

    def one_by_one() -> list[object]:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            return [
                pywt.wavedec(signal, "db2", mode="symmetric", level=3)
                for signal in signals.reshape(-1, 5)
            ]

    return {
        "ours": lambda: wavelet_levels(signals, SequenceParameters()),
        "PyWavelets, all at once": lambda: pywt.wavedec(signals, "db2", "symmetric", 3, axis=2),
        "PyWavelets, one sequence at a time": one_by_one,
    }


def plain_scikit_learn(table: pa.Table, parameters: RecognitionParameters) -> float:
    """Train and test every split with scikit-learn alone; gives the mean accuracy."""
    from sklearn.decomposition import PCA
    from sklearn.model_selection import GridSearchCV, GroupKFold
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import StandardScaler
    from sklearn.svm import SVC

    sequences = gather_pipeline(table, parameters, "best")
    waves = draw_waves(parameters.best, np.random.default_rng(0))
    rows = describe_sequences(sequences.features, sequences.feature_names, waves, parameters.best)
    owners, labels = sequences.object_index, sequences.labels
    found = []
    for split, _ in draw_splits(sequences, parameters, 1):
        steps = make_pipeline(StandardScaler(), PCA(parameters.best.components), SVC())
        folds = GroupKFold(parameters.best.inner_folds)
        search = GridSearchCV(steps, {"svc__C": [1.0, 10.0]}, cv=folds)
        search.fit(rows[split.train], labels[split.train], groups=owners[split.train])
        found.append(search.score(rows[split.test], labels[split.test]))
    return float(np.mean(found))


def _compare(peers: Peers, rounds: int = ROUNDS) -> dict[str, object]:
    seconds = in_turn(peers, rounds)
    return {"milliseconds": medians(seconds, 1e3), "ratio_to_ours": ratios(seconds, "ours")}


def features_of_the_papers_shape() -> pa.Table:
    """Give 4 classes of 3 objects with 16 sequences of 5 touches, of made-up features."""
    generator = np.random.default_rng(2)
    places = np.indices((4, 3, 16, 5)).reshape(4, -1)
    columns: dict[str, object] = {
        "class": [f"class{place}" for place in places[0]],
        "object": [f"object{place}" for place in places[1]],
        "viewpoint": places[2],
        "strategy": "fixation",
        "touch": places[3],
        "contact_state": "full",
    }
    measured = [column.name for column in FEATURES.columns if column.name not in columns]
    for name in measured:
        centres = generator.normal(size=(4, 3))[places[0], places[1]]
        columns[name] = 0.5 + 0.5 * np.tanh(centres + generator.normal(size=centres.shape))
    return build_table(FEATURES, columns)


if __name__ == "__main__":
    print(json.dumps(run(), indent=1))
