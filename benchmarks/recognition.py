"""Seconds of training and testing, and the batch map beside MiniSom's own trainings.

Run as ``python benchmarks/recognition.py``. Peers take turns in every round; figures are medians
over the rounds, ratios are medians of ratios within a round.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Mapping
from statistics import median

import numpy as np
import pyarrow as pa
import pywt
from minisom import MiniSom
from numpy.typing import NDArray

from visuohaptic import recognition
from visuohaptic.recognition.parameters import (
    RecognitionParameters,
    SelfOrganisingMapParameters,
    SequenceParameters,
)
from visuohaptic.recognition.self_organising_map import fit_batch_map, line
from visuohaptic.recognition.sequence_features import wavelet_levels
from visuohaptic.tables.phases import CONTOURLET_FEATURES, FEATURES, KINESTHETIC_FEATURES
from visuohaptic.tables.schema import build_table

ROUNDS = 5
PIPELINE_ROUNDS = 3


def run() -> dict[str, object]:
    """Measure maps, transforms and whole pipelines.

    Returns
    -------
    dict
        ``map`` and ``wavelet``: ``milliseconds`` by peer and ``ratio_to_ours``; ``map`` also
        ``quantisation_error``. ``pipeline_seconds``: 81 splits of one strategy of a set of the
        paper's shape, by pipeline, imports apart; ``paper_both_strategies_seconds``.
    """
    touches = np.random.default_rng(0).normal(size=(640, 22))
    maps = _maps(touches)
    table = _features_of_the_papers_shape()
    parameters = RecognitionParameters()
    recognition.run_pipeline(table, parameters, 1)  # brings the imports
    seconds = {
        pipeline: median(
            _seconds(lambda name=pipeline: recognition.run_pipeline(table, parameters, 1, name))
            for _ in range(rounds)
        )
        for pipeline, rounds in {"paper": PIPELINE_ROUNDS, "best": 1}.items()
    }
    return {
        "rounds": ROUNDS,
        "map": _compare(maps) | {"quantisation_error": {name: maps[name]() for name in maps}},
        "wavelet": _compare(_transforms()),
        "pipeline_seconds": seconds,
        "paper_both_strategies_seconds": 2 * seconds["paper"],
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
        "PyWavelets, one sequence at a time": one_by_one,
    }


def _compare(peers: Mapping[str, Callable[[], object]]) -> dict[str, object]:
    rounds = [{name: _seconds(peer) for name, peer in peers.items()} for _ in range(ROUNDS)]
    return {
        "milliseconds": {name: 1e3 * median(turn[name] for turn in rounds) for name in peers},
        "ratio_to_ours": {
            name: median(turn[name] / turn["ours"] for turn in rounds) for name in peers
        },
    }


def _seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def _features_of_the_papers_shape() -> pa.Table:
    """Give 4 classes of 3 objects with 16 sequences of 5 touches, of made-up features."""
    generator = np.random.default_rng(2)
    places = np.indices((4, 3, 16, 5)).reshape(4, -1)
    centres = generator.normal(size=(4, 3, 22))[places[0], places[1]]
    values = centres + generator.normal(size=centres.shape)
    columns: dict[str, object] = {
        "class": [f"class{place}" for place in places[0]],
        "object": [f"object{place}" for place in places[1]],
        "viewpoint": places[2],
        "strategy": "fixation",
        "touch": places[3],
    }
    columns |= dict(zip(CONTOURLET_FEATURES, np.abs(values[:, :16]).T, strict=True))
    columns |= dict(zip(KINESTHETIC_FEATURES, np.tanh(values[:, 16:]).T, strict=True))
    return build_table(FEATURES, columns)


def main() -> None:
    """Print the figures as a short table."""
    figures = run()
    for section in ("map", "wavelet"):
        measured = figures[section]
        assert isinstance(measured, dict)  # noqa: S101 - for the type checker
        for name, milliseconds in measured["milliseconds"].items():
            ratio = measured["ratio_to_ours"][name]
            print(f"{section:8} {name:36} {milliseconds:9.2f} ms  {ratio:7.1f} x ours")
    print("quantisation error", figures["map"]["quantisation_error"])  # type: ignore[index]
    print("81 splits, seconds a strategy", figures["pipeline_seconds"])


if __name__ == "__main__":
    main()
