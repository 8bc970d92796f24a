"""Choose what pipeline `learned` trains on: ``python -m learned.training results/meshes``.

The argument is the folder of prepared meshes of a run of set ``benchmark``; the choosing objects are touched anew.
Sequences and scores that lie in folder `--touched` are read instead of measured: empty the folder after a change of code.

The rule, written before any score was computed:

1. A gain is the accuracy minus the accuracy after training with the touches of the tested strategy only, on the
   choosing objects in five folds of whole objects: a mean over the frames ``full`` and ``none``, and over fixation and
   random places in reach.
2. An option is taken in if the interval of its gain is above 0, it loses in no frame, a model of 142 objects is fitted
   within 300 processor seconds, and it needs no touches that a run does not make. Of several, the one with the largest
   gain is taken, and of those within 0.3 points, the one with the fewest steps of training.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from numpy.typing import NDArray
from sklearn.base import clone
from sklearn.model_selection import StratifiedGroupKFold

from classifier_settings.half import choosing_objects
from learned.choose import FOLDS, FRAMES, SEED, STRATEGIES
from visuohaptic.base.arrays import FloatArray
from visuohaptic.evaluation.intervals import compare_paired
from visuohaptic.geometry.surface import object_of
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.experiment import one_thread
from visuohaptic.recognition.parameters import (
    TOUCH_NETWORK,
    Frame,
    IntervalParameters,
    RecognitionParameters,
)
from visuohaptic.recognition.pipelines import LearnedPipeline
from visuohaptic.recognition.sequences import TouchSequences, gather_pipeline, join_sequences
from visuohaptic.recognition.touch_network import descriptors_of
from visuohaptic.studies.conditions import Recomputation
from visuohaptic.studies.recomputing import Sources, recompute_features

FEWER_TOUCHES = 4
STRETCH = 0.1
"""Standard deviation of the logarithm of a copy's factor along each axis."""
NOISE = 0.1
"""Standard deviation of the noise of a copy, in standard deviations of each number."""
CELLS = tuple((tested, frame) for frame in FRAMES for tested in STRATEGIES)
"""Tested strategies and frames over which gains are averaged."""
MARGIN = 0.003
"""Options within this share of the best count as equal."""
RING_DEGREES = 50.0
"""Elevation of the second ring of views."""

Touched = Mapping[str, TouchSequences]
"""Sequences by strategy; `RING` and `TURNED` have other views and poses of the strategies."""
RING, TURNED = "ring", "turned"
Copies = Callable[[TouchSequences], TouchSequences]


@dataclass(frozen=True)
class Option:
    """What trains beside the touches of the tested strategy.

    Attributes
    ----------
    more : tuple of str
        Further strategies, of `Touched`; in `RING` and `TURNED` that of the test.
    copies : callable, optional
        Changes copies of the sequences, which train beside them.
    share : float
        Share of the passes.
    frames : tuple of str
        Frames in which more trains; a mirror changes nothing where nothing of the pose is known.
    """

    more: tuple[str, ...] = ()
    copies: Copies | None = None
    share: float = 1.0
    frames: tuple[Frame, ...] = FRAMES

    @property
    def steps(self) -> float:
        """Steps of training, relative to those of the tested strategy's touches only."""
        parts = max(len(self.more), 1) + (self.more in {(RING,), (TURNED,)})
        return parts * (1 if self.copies is None else 2) * self.share


def mirrored(sequences: TouchSequences) -> TouchSequences:
    """Reflect touches left and right; bands of opposite directions change their places."""
    features, names = sequences.features.copy(), list(sequences.feature_names)
    features[..., [names.index("x"), names.index("normal_x")]] *= -1
    bands = [index for index, name in enumerate(names) if name.startswith("contourlet_")]
    half = len(bands) // 2
    features[..., bands] = sequences.features[..., bands[half - 1 :: -1] + bands[: half - 1 : -1]]
    return replace(sequences, features=features)


def stretched(sequences: TouchSequences) -> TouchSequences:
    """Stretch each object by random factors along the axes; imprints stay."""
    features, names = sequences.features.copy(), list(sequences.feature_names)
    generator = np.random.default_rng(SEED)
    drawn = np.exp(generator.normal(0, STRETCH, (len(sequences.objects), 3)))
    factors = drawn[sequences.object_index][:, None]
    point, normal = ([names.index(f"{kind}{axis}") for axis in "xyz"] for kind in ("", "normal_"))
    features[..., point] *= factors
    features[..., normal] /= factors
    features[..., normal] /= np.linalg.norm(features[..., normal], axis=-1, keepdims=True)
    return replace(sequences, features=features)


def noisy(sequences: TouchSequences) -> TouchSequences:
    """Add noise to all numbers of the touches."""
    features = sequences.features
    scale = NOISE * features.std(axis=(0, 1))
    drawn = np.random.default_rng(SEED).normal(size=features.shape)
    return replace(sequences, features=features + scale * drawn)


def shortened(sequences: TouchSequences) -> TouchSequences:
    """Leave out touches of each sequence by chance."""
    ranks = np.random.default_rng(SEED).random(sequences.features.shape[:2]).argsort(axis=1)
    kept = np.sort(ranks[:, :FEWER_TOUCHES], axis=1)
    rows = np.arange(len(kept))[:, None]
    return replace(sequences, features=sequences.features[rows, kept])


KINDS = ("fixation", "random", "random_visible")
DRAWS = ("random#1", "random#2")
OPTIONS: Mapping[str, Option] = {
    "own": Option(),
    "strategies": Option(KINDS),
    "strategies, as many steps": Option(KINDS, share=1 / 3),
    "strategies and draws, as many steps": Option((*KINDS, *DRAWS), share=1 / 5),
    "second ring of views": Option((RING,)),
    "mirrored copies": Option(copies=mirrored, frames=("full",)),
    "stretched copies": Option(copies=stretched),
    "noisy copies": Option(copies=noisy),
    "copies with a touch left out": Option(copies=shortened),
    "turned objects": Option((TURNED,), frames=("none",)),
}


def touch(
    meshes: Sequence[Path], folder: Path, name: str, changes: Mapping[str, object]
) -> dict[str, TouchSequences]:
    """Touch the objects of mesh files with changed parameters, or read what was touched before; by strategy."""
    parameters = ExperimentParameters.from_mapping(dict(changes))
    path = folder / f"{name}.parquet"
    if not path.exists():
        made = recompute_features(Recomputation("views", parameters), Sources(meshes=meshes))
        pq.write_table(made, path)
    table: pa.Table = pq.read_table(path)
    return {
        strategy: gather_pipeline(
            table.filter(pc.equal(table["strategy"], strategy)),
            RecognitionParameters(),
            "learned",
            SEED,
        )
        for strategy in parameters.probing.strategies
    }


def touch_all(meshes: Sequence[Path], folder: Path) -> dict[str, Touched]:
    """Touch the objects in all ways that the options need; by tested strategy."""
    both = {"probing": {"strategies": list(STRATEGIES)}}
    ring = {"viewpoints": {"elevations_degrees": [RING_DEGREES]}, **both}
    turned = {"meshes": {"turns": "any"}, **both}
    own = touch(meshes, folder, "own", {"probing": {"strategies": [*KINDS, *DRAWS]}})
    rings, turns = touch(meshes, folder, RING, ring), touch(meshes, folder, TURNED, turned)
    return {name: {**own, RING: rings[name], TURNED: turns[name]} for name in STRATEGIES}


def correct(touched: Touched, tested: str, option: Option, frame: Frame) -> FloatArray:
    """Return whether each sequence of the tested strategy is classified right, (2, s): by `learned`, by its discriminant."""
    parameters = RecognitionParameters(frame=frame)
    pipeline = LearnedPipeline.of(parameters, SEED)
    option = option if frame in option.frames else OPTIONS["own"]
    joined = join_sequences([touched[name] for name in dict.fromkeys((tested, *option.more))])
    parts = [joined] if option.copies is None else [joined, option.copies(joined)]
    described = [pipeline.rows(part) for part in parts]
    rows = np.concatenate([_with_elements(one, described[0].dtype) for one in described])
    labels, owners = (
        np.tile(values, len(parts)) for values in (joined.labels, joined.object_index)
    )
    own, count = touched[tested], len(touched[tested].features)
    passes = max(1, round(option.share * pipeline.classifiers[TOUCH_NETWORK].network.max_iter))
    found = np.zeros((2, count))
    folds = StratifiedGroupKFold(FOLDS, shuffle=True, random_state=0)
    for train, test in folds.split(own.labels, own.labels, owners[:count]):
        trains = np.isin(owners, owners[train])
        with one_thread():
            preparation = clone(pipeline.preparation).set_params(random_state=0)
            prepared = preparation.fit(rows[trains]).transform(rows[trains])
            model = clone(pipeline.classifiers[TOUCH_NETWORK])
            model.set_params(random_state=0, network__max_iter=passes)
            model.fit(prepared, labels[trains])
            tested_rows = preparation.transform(rows[test])
            found[0, test] = model.predict(tested_rows) == labels[test]
            by_discriminant = model.discriminant_.predict(descriptors_of(tested_rows))
            found[1, test] = by_discriminant == labels[test]
    return found


def _with_elements(rows: NDArray[np.void], dtype: np.dtype[np.void]) -> NDArray[np.void]:
    """Return rows with as many elements as `dtype` has; the first elements are repeated where there are fewer."""
    filled = np.empty(len(rows), dtype=dtype)
    filled["descriptors"] = rows["descriptors"]
    wanted = filled["elements"].shape[1]
    filled["elements"] = rows["elements"][:, np.arange(wanted) % rows["elements"].shape[1]]
    return filled


def taken(found: Mapping[str, Any]) -> str:
    """Return the option that the rule takes in; ``own`` if it admits none. The fit's seconds are not checked here."""
    admitted = {
        name: one["gain"][0]
        for name, one in found.items()
        if one["gain"][1] > 0
        and not {*OPTIONS[name].more} & {RING, TURNED}
        and _loses_nowhere(one, found["own"])
    }
    close = [name for name, gained in admitted.items() if gained >= max(admitted.values()) - MARGIN]
    return min(close, key=lambda name: OPTIONS[name].steps, default="own")


def _loses_nowhere(one: Mapping[str, Any], own: Mapping[str, Any]) -> bool:
    """Return whether an option has no lower mean accuracy than ``own`` in any frame."""

    def by_frame(scores: Mapping[str, Any], frame: Frame) -> float:
        return sum(scores["accuracy"][f"{tested} {frame}"] for tested in STRATEGIES)

    return all(by_frame(one, frame) >= by_frame(own, frame) for frame in FRAMES)


def main() -> None:
    """Write the accuracy by every option, and its gain over touches of the tested strategy."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("meshes", type=Path, help="results/meshes of a run of set benchmark")
    parser.add_argument("--touched", type=Path, default=Path("results/training"))
    parser.add_argument("--output", type=Path, default=Path("studies/learned/training.json"))
    arguments = parser.parse_args()
    arguments.touched.mkdir(parents=True, exist_ok=True)
    chose = choosing_objects()
    meshes = sorted(path for path in arguments.meshes.rglob("*.ply") if object_of(path) in chose)
    touched = touch_all(meshes, arguments.touched)
    shares = {name: shares_of(touched, name, arguments.touched) for name in OPTIONS}
    found = {
        name: {
            "accuracy": dict(
                zip(map(" ".join, CELLS), one[:, 0].mean(axis=1).round(4).tolist(), strict=True)
            ),
            "gain": gain(one[:, 0], shares["own"][:, 0]),
            "discriminant": gain(one[:, 1], shares["own"][:, 1]),
        }
        for name, one in shares.items()
    }
    arguments.output.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


def shares_of(touched: Mapping[str, Touched], name: str, folder: Path) -> FloatArray:
    """Measure an option, or read what was measured before: (c, 2, o) for the cells of `CELLS` and o objects."""
    path = folder / f"{name}.npy"
    if not path.exists():
        shares = [
            by_object(
                correct(touched[tested], tested, OPTIONS[name], frame), touched[tested][tested]
            )
            for tested, frame in CELLS
        ]
        np.save(path, np.array(shares))
    measured: FloatArray = np.load(path)
    return measured


def by_object(right: FloatArray, sequences: TouchSequences) -> FloatArray:
    """Return the share of each object's sequences that is classified right: (2, s) to (2, o)."""
    owners = sequences.object_index
    return np.stack([np.bincount(owners, weights=one) / np.bincount(owners) for one in right])


def gain(shares: FloatArray, own: FloatArray) -> list[float]:
    """Return the mean over cells and objects, (c, o) each, of the first minus the second, and its 95 % interval."""
    difference = compare_paired(
        shares.mean(axis=0), own.mean(axis=0), np.ones(shares.shape[1]), IntervalParameters()
    ).difference
    return [round(value, 4) for value in (difference.mean, difference.low, difference.high)]


if __name__ == "__main__":
    main()
