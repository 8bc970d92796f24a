"""The recognition model that a run leaves behind, with how its touches were made."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from visuohaptic.recognition.classifiers import ClassifierName
from visuohaptic.recognition.model import fit_model
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.sequences import take_strategy
from visuohaptic.recognition.stored_models import save_model
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table


def make_model(
    features: Sequence[str | Path],
    model: str | Path,
    pipeline: str,
    classifier: ClassifierName,
    strategy: str,
    recognition: RecognitionParameters,
    touching: Mapping[str, object],
    seed: int,
) -> None:
    """Fit a model on every object of a run, and write it with the parameters that made its touches.

    Raises `RecognitionError` if the table has no touch of the strategy, or not what training needs.
    """
    table, _ = take_strategy(read_table(FEATURES, features), strategy, recognition.touches)
    fitted = fit_model(table, pipeline, classifier, recognition, seed)
    save_model(replace(fitted, touching=json.dumps(touching)), model)
