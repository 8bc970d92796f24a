"""Choose the descriptors of frame `none` of pipeline `order_free`: `python -m frame_descriptors.choose`.

README.md beside this file states the rule. It was written before any score was computed.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray
from sklearn.model_selection import StratifiedGroupKFold, cross_val_score

from classifier_settings.choose import HALVES_SEED, choosing_half, first_near_best
from frame_descriptors.families import local_frames, pair_waves, spectral_moments, triples
from turned.study import STUDY, name_of
from visuohaptic.meshes.catalogue import models_of_set
from visuohaptic.parameters import as_parameters
from visuohaptic.recognition.descriptors import POSE, describe_sequences, draw_waves
from visuohaptic.recognition.experiment import one_thread
from visuohaptic.recognition.frames import WaveBasis
from visuohaptic.recognition.parameters import OrderFreeParameters, RecognitionParameters
from visuohaptic.recognition.pipelines import make_order_free
from visuohaptic.recognition.sequences import TouchSequences, gather_pipeline, take_strategy
from visuohaptic.studies.conditions import plan_study
from visuohaptic.tables.phases import FEATURES, keys_of
from visuohaptic.tables.schema import read_table

ROUNDS = 2
FOLDS = 5
TOUCHES = 5
STRATEGY = "fixation"
DRAWS = (3, 4)
MARGIN = 0.005
"""A family is preferred to later families that are more accurate by at most this share of the sequences."""

Family = Callable[[NDArray[np.float64], NDArray[np.float64], WaveBasis], NDArray[np.float64]]

FAMILIES: Mapping[str, Sequence[Family]] = {
    "baseline": (),
    "spectral moments": (spectral_moments,),
    "waves over pairs": (pair_waves,),
    "local reference frames": (local_frames,),
    "triples": (triples,),
    "all together": (spectral_moments, pair_waves, local_frames, triples),
}
"""Descriptors that are added to `BASELINE`, sorted by the number of values."""

BASELINE = RecognitionParameters(
    frame="none",
    order_free=OrderFreeParameters(cues=("contourlet", "imprint", "sensor", "relations")),
)


def read_turned(results: Path, draw: int, half: set[str]) -> TouchSequences:
    """Read the sequences of draw `draw` of meshes turned by any rotation, for the objects ``class/name`` of `half`."""
    run = as_parameters({"meshes.set": "benchmark"})
    (key,) = (
        planned.key
        for planned in plan_study(STUDY, run).conditions
        if planned.condition.name == name_of("any", draw, BASELINE.frame, TOUCHES)
    )
    table = read_table(FEATURES, results / "study_features" / STUDY.name / f"{key}.parquet")
    table = table.filter(pc.is_in(keys_of(table), value_set=pa.array(sorted(half))))
    touches, _ = take_strategy(table, STRATEGY, TOUCHES)
    return gather_pipeline(touches, BASELINE, "order_free")


def describe(
    sequences: TouchSequences, families: Sequence[Family], waves: WaveBasis
) -> NDArray[np.float64]:
    """Compute the descriptors of s sequences by `BASELINE` and by families, shape (s, d)."""
    names = sequences.feature_names
    pose = sequences.features[:, :, [names.index(name) for name in POSE]]
    points, normals = pose[..., :3], pose[..., 3:]
    parts = [describe_sequences(sequences.features, names, waves, BASELINE)]
    parts += [family(points, normals, waves) for family in families]
    return np.concatenate(parts, axis=1)


def score(rows: NDArray[np.float64], sequences: TouchSequences) -> float:
    """Compute the mean share of correctly classified sequences over rounds and folds of whole objects."""
    scores: list[float] = []
    for round_number in range(ROUNDS):
        folds = StratifiedGroupKFold(FOLDS, shuffle=True, random_state=round_number)
        with one_thread():
            scores += cross_val_score(
                make_order_free(), rows, sequences.labels, groups=sequences.object_index, cv=folds
            ).tolist()
    return float(np.mean(scores))


def main() -> None:
    """Print and write the mean accuracy of every family on the objects of `choosing_half`."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, help="folder results/ of `make turned SET=benchmark`")
    parser.add_argument("--catalogue", type=Path, default=Path("meshes/catalogue.csv"))
    parser.add_argument("--output", type=Path, default=Path("chosen_descriptors.json"))
    arguments = parser.parse_args()
    half = choosing_half(models_of_set(arguments.catalogue, "outside"), HALVES_SEED)
    drawn = [read_turned(arguments.results, draw, half) for draw in DRAWS]
    waves = draw_waves(OrderFreeParameters(), as_parameters(None).seed)
    accuracy, numbers = {}, {}
    for name, families in FAMILIES.items():
        described = [describe(sequences, families, waves) for sequences in drawn]
        values = [score(*pair) for pair in zip(described, drawn, strict=True)]
        accuracy[name], numbers[name] = float(np.mean(values)), described[0].shape[1]
        print(f"{name}: {100 * accuracy[name]:.2f} %, {numbers[name]} numbers", flush=True)
    result = {
        "objects": len(half),
        "accuracy": accuracy,
        "numbers": numbers,
        "chosen": first_near_best(accuracy, MARGIN),
    }
    arguments.output.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
