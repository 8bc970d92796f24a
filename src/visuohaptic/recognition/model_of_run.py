"""Write the recognition model of a run, with the parameters that made its touches."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import pyarrow as pa

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
    strategies: Sequence[str],
    recognition: RecognitionParameters,
    touching: Mapping[str, object],
    seed: int,
) -> None:
    """Fit a model on the touches by `strategies` of all objects of a run, and write the file `model`.

    `features` are Parquet files of `tables.FEATURES`. `touching` has the parameters that made the touches; the model
    stores `touching` as JSON. Other parameters are as in `fit_model`, which names `recognition` `parameters`. Errors
    are as in `take_strategy` and `fit_model`.
    """
    table = read_table(FEATURES, features)
    parts = [take_strategy(table, name, recognition.touches)[0] for name in strategies]
    fitted = fit_model(pa.concat_tables(parts), pipeline, classifier, recognition, seed)
    save_model(replace(fitted, touching=json.dumps(touching)), model)
