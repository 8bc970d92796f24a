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
    """Fit a model on all objects of a run, and write the model.

    Parameters
    ----------
    features : sequence of path
        Parquet files of `tables.FEATURES`.
    model : path
        Output file.
    pipeline, classifier : str
        Pipeline and classifier to fit.
    strategies : sequence of str
        Strategies whose touches are used.
    recognition : RecognitionParameters
        Settings of the fit.
    touching : mapping of str to object
        Parameters that made the touches; stored as JSON.
    seed : int
        Seed of the fit.

    Raises
    ------
    RecognitionError
        If the table has no touch of a strategy, or `fit_model` can't fit the features.
    """
    table = read_table(FEATURES, features)
    parts = [take_strategy(table, name, recognition.touches)[0] for name in strategies]
    fitted = fit_model(pa.concat_tables(parts), pipeline, classifier, recognition, seed)
    save_model(replace(fitted, touching=json.dumps(touching)), model)
