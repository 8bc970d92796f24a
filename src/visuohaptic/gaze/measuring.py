"""From recordings to the table of gaze: every prediction compared with people on every object."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa

from visuohaptic.attention.registry import CHANNELS
from visuohaptic.attention.surface_measures import MEASURES
from visuohaptic.errors import GazeError
from visuohaptic.gaze.looking import GazedObject
from visuohaptic.gaze.parameters import GazeParameters
from visuohaptic.gaze.predicting import BY_NAME, PREDICTORS, fit_predictor, predict, weights_of
from visuohaptic.tables.gaze import GAZE
from visuohaptic.tables.schema import build_rows


def measure_all(objects: Sequence[GazedObject], gaze: GazeParameters) -> pa.Table:
    """Compare every predictor with people on every object: rows of `tables.GAZE`.

    Raises `GazeError` where too few objects are there to hold some of them out.
    """
    families = {one.family for one in objects if not one.is_test}
    if len(families) < gaze.folds:
        raise GazeError(
            f"{len(families)} different objects are there to fit weights to; gaze.folds is {gaze.folds}, "
            "and so many are needed."
        )
    rows: list[dict[str, object]] = []
    for predictor in PREDICTORS:
        weights = weights_of(objects, predictor, gaze)
        for one in objects:
            if predictor.kind == "peer" and one.peer is None:
                continue
            values = predict(one, predictor, weights[one.name])
            rows.append(
                {
                    "object": one.name,
                    "predictor": predictor.name,
                    "part": "test" if one.is_test else "training",
                    **{name: measure(values, one.gazed) for name, measure in MEASURES.items()},
                    "alignment_error": one.error,
                    "reconstructed": one.is_reconstructed,
                    "gaze_seconds": one.seconds,
                    "seen_share": one.seen_share,
                    "digest": one.digest,
                }
            )
    return build_rows(GAZE, rows)


def human_weights(objects: Sequence[GazedObject], gaze: GazeParameters) -> dict[str, Any]:
    """Fit all channels and terms to all training objects, as `attention.weights: human` takes them.

    Beside ``channels`` and ``terms`` are the ``objects`` fitted to, and ``sha256`` of their recordings.
    """
    training = sorted((one for one in objects if not one.is_test), key=lambda one: one.name)
    tested = {one.family for one in objects if one.is_test}
    weights = fit_predictor(training, BY_NAME["human"].features, tested, gaze.penalty)
    rounded = {name: float(np.round(weight, 4)) for name, weight in weights.items()}
    digest = hashlib.sha256("".join(one.digest for one in training).encode()).hexdigest()
    return {
        "channels": {name: rounded[name] for name in CHANNELS},
        "terms": {name: value for name, value in rounded.items() if name not in CHANNELS},
        "objects": [one.name for one in training],
        "sha256": digest,
    }
