"""Read the feature table, and write the score and prediction tables."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from pathlib import Path

from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.sequences import take_strategy
from visuohaptic.tables.phases import FEATURES, PREDICTIONS, SCORES
from visuohaptic.tables.schema import read_table, write_table

logger = logging.getLogger(__name__)


def make_scores(
    features: Sequence[str | Path],
    scores: Mapping[str, str | Path],
    predictions: Mapping[str, str | Path],
    pipeline: str,
    parameters: RecognitionParameters,
    seed: int,
) -> None:
    """Write the score and prediction tables of one pipeline.

    Parameters
    ----------
    features : sequence of path
        Parquet files of `tables.FEATURES`.
    scores, predictions : mapping of str to path
        Output file of each strategy.
    pipeline : {"paper", "order_free"}
        Pipeline to run.
    parameters : RecognitionParameters
        Settings of recognition.
    seed : int
        Seed of splits and fits.

    Raises
    ------
    RecognitionError
        If the features have no touch of a strategy, or not enough objects, viewpoints or touches.
    """
    touched = read_table(FEATURES, features)
    for strategy, output in scores.items():
        table, left_out = take_strategy(touched, strategy, parameters.touches)
        for sentence in left_out:
            logger.warning(sentence)
        scored, predicted = run_pipeline(table, parameters, seed, pipeline)
        write_table(SCORES, scored, output)
        write_table(PREDICTIONS, predicted, predictions[strategy])
