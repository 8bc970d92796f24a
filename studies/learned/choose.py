"""Choose the settings of pipeline `learned`: ``python -m learned.choose FEATURES``.

The rule, written before any score was computed:

1. For touches (frame ``full``) and for pairs (frame ``none``), the passes (20, 40, 80) and the weight of the discriminant
   (0.1, 0.2, 0.5, 1) with the highest mean over fixation and random places in reach are found. Choosing objects only.
2. Of settings within 0.3 points of the best, the one with the fewest passes is taken, and of these the best.

Until 29 November 2026 the mean over both frames was taken, and pairs had 80 passes too.
"""

from __future__ import annotations

import argparse
import json
from itertools import product
from pathlib import Path

import numpy as np
import pyarrow.compute as pc
from sklearn.base import clone
from sklearn.model_selection import StratifiedGroupKFold

from classifier_settings.half import choosing_objects
from visuohaptic.recognition.experiment import one_thread
from visuohaptic.recognition.parameters import (
    TOUCH_NETWORK,
    Frame,
    LearnedParameters,
    RecognitionParameters,
)
from visuohaptic.recognition.pipelines import LearnedPipeline
from visuohaptic.recognition.sequences import TouchSequences, gather_pipeline
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table

FOLDS = 5
SEED = 2018
STRATEGIES = ("fixation", "random")
FRAMES: tuple[Frame, ...] = ("full", "none")
PASSES = (20, 40, 80)
WEIGHTS = (0.1, 0.2, 0.5, 1.0)


def choosing_sequences(path: Path, strategy: str) -> TouchSequences:
    """Return the sequences of the choosing objects by a strategy."""
    features = read_table(FEATURES, path)
    of_strategy = features.filter(pc.equal(features.column("strategy"), strategy))
    sequences = gather_pipeline(of_strategy, RecognitionParameters(), "learned", SEED)
    is_choosing = np.array(["/".join(owner) in choosing_objects() for owner in sequences.objects])
    return sequences.take(is_choosing[sequences.object_index])


def scores(sequences: TouchSequences, frame: Frame, passes: int) -> list[float]:
    """Return the share of correctly classified sequences in folds of whole objects, by the weights of `WEIGHTS`."""
    learned = LearnedParameters(passes=passes, pair_passes=passes)
    parameters = RecognitionParameters(frame=frame, learned=learned)
    pipeline = LearnedPipeline.of(parameters, SEED)
    rows, labels = pipeline.rows(sequences), sequences.labels
    correct = np.zeros((len(WEIGHTS), len(rows)))
    folds = StratifiedGroupKFold(FOLDS, shuffle=True, random_state=0)
    for train, test in folds.split(labels, labels, sequences.object_index):
        with one_thread():
            unfitted = clone(pipeline.classifiers[TOUCH_NETWORK]).set_params(random_state=0)
            model = unfitted.fit(rows[train], labels[train])
            for index, weight in enumerate(WEIGHTS):
                model.discriminant_weight = weight
                correct[index, test] = model.predict(rows[test]) == labels[test]
    return correct.mean(axis=1).tolist()


def main() -> None:
    """Write the mean accuracy over strategies of every frame and number of passes, by weight."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("features", type=Path, help="recomputed features of set benchmark, upright")
    parser.add_argument("--output", type=Path, default=Path("studies/learned/chosen.json"))
    arguments = parser.parse_args()
    by_strategy = [choosing_sequences(arguments.features, name) for name in STRATEGIES]
    accuracy = {
        f"{frame} {passes}": np.mean([scores(own, frame, passes) for own in by_strategy], axis=0)
        for frame, passes in product(FRAMES, PASSES)
    }
    found = {
        "weights": WEIGHTS,
        "accuracy": {name: means.round(4).tolist() for name, means in accuracy.items()},
    }
    arguments.output.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
