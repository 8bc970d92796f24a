"""Write the recognition model of a run, with the parameters that made its touches."""

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
    """Fit a model on all objects of a run, and write the model.

    Parameters
    ----------
    features : sequence of path
        Parquet files of `tables.FEATURES`.
    model : path
        Output file.
    pipeline, classifier, strategy : str
        Pipeline and classifier to fit, and the strategy whose touches are used.
    recognition : RecognitionParameters
        Settings of the fit.
    touching : mapping of str to object
        Parameters that made the touches; stored as JSON.
    seed : int
        Seed of the fit.

    Raises
    ------
    RecognitionError
        If the table has no touch of the strategy, or `fit_model` can't fit the features.
    """
    table, _ = take_strategy(read_table(FEATURES, features), strategy, recognition.touches)
    fitted = fit_model(table, pipeline, classifier, recognition, seed)
    save_model(replace(fitted, touching=json.dumps(touching)), model)
