"""Compute the table of agreement: every predictor compared with people on every object."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from human_gaze.gazed_objects import GazedObject, GazeSettings
from human_gaze.predicting import BY_NAME, PREDICTORS, fit_predictor, predict, weights_of
from human_gaze.recordings import GazeError
from human_gaze.surface_measures import MEASURES
from human_gaze.tables import AGREEMENT
from visuohaptic.attention.registry import CHANNELS
from visuohaptic.base.atomic_files import atomic_write_text
from visuohaptic.tables.schema import build_rows


def measure_all(objects: Sequence[GazedObject], settings: GazeSettings) -> pa.Table:
    """Compare every predictor with people on every object; return rows of `AGREEMENT`.

    Raises `GazeError` if there are fewer families of training objects than folds.
    """
    families = {gazed.family for gazed in objects if not gazed.is_test}
    if len(families) < settings.folds:
        raise GazeError(
            f"There are {len(families)} different objects to fit weights to; {settings.folds} folds need at least "
            f"{settings.folds}."
        )
    rows: list[dict[str, object]] = []
    for predictor in PREDICTORS:
        weights = weights_of(objects, predictor, settings)
        for gazed in objects:
            if predictor.kind == "peer" and gazed.peer is None:
                continue
            values = predict(gazed, predictor, weights[gazed.name])
            rows.append(
                {
                    "object": gazed.name,
                    "predictor": predictor.name,
                    "part": "test" if gazed.is_test else "training",
                    **{name: measure(values, gazed.gazed) for name, measure in MEASURES.items()},
                    "alignment_error": gazed.error,
                    "reconstructed": gazed.is_reconstructed,
                    "gaze_seconds": gazed.seconds,
                    "seen_share": gazed.seen_share,
                    "digest": gazed.digest,
                }
            )
    return build_rows(AGREEMENT, rows)


def human_weights(objects: Sequence[GazedObject], settings: GazeSettings) -> dict[str, Any]:
    """Fit the weights of all channels and terms to all training objects, for strategy ``human``.

    Returns weights ``channels`` and ``terms`` by name, names of the training ``objects``, and ``sha256`` over the digests
    of their recordings. Raises `GazeError` as `fit_predictor` does.
    """
    training = sorted(
        (gazed for gazed in objects if not gazed.is_test), key=lambda gazed: gazed.name
    )
    tested = {gazed.family for gazed in objects if gazed.is_test}
    weights = fit_predictor(training, BY_NAME["human"].features, tested, settings.penalty)
    rounded = {name: float(np.round(weight, 4)) for name, weight in weights.items()}
    digest = hashlib.sha256("".join(gazed.digest for gazed in training).encode()).hexdigest()
    return {
        "channels": {name: rounded[name] for name in CHANNELS},
        "terms": {name: value for name, value in rounded.items() if name not in CHANNELS},
        "objects": [gazed.name for gazed in training],
        "sha256": digest,
    }


def write_weights(
    objects: Sequence[GazedObject],
    settings: GazeSettings,
    path: str | Path,
    command: str,
    source: str,
) -> None:
    """Write the weights of `human_weights` as JSON, in the form of ``attention/human_weights.json``.

    `source` is the origin of the recordings, and `command` the command that fits the weights.
    """
    content: dict[str, Any] = {
        "source": source,
        "date": datetime.now(UTC).date().isoformat(),
        "command": command,
        **human_weights(objects, settings),
    }
    atomic_write_text(path, json.dumps(content, indent=2) + "\n")
