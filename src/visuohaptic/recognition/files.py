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
    """Train and test a pipeline on the touches by each strategy, and write the scores and predictions.

    `features` are Parquet files of `tables.FEATURES`. `scores` and `predictions` have the output file of each strategy.
    `pipeline` is a name that `pipeline_of` takes. Other parameters are as in `run_pipeline`, and errors as in
    `take_strategy` and `run_pipeline`.
    """
    touched = read_table(FEATURES, features)
    for strategy, output in scores.items():
        table, left_out = take_strategy(touched, strategy, parameters.touches)
        for sentence in left_out:
            logger.warning(sentence)
        scored, predicted = run_pipeline(table, parameters, seed, pipeline)
        write_table(SCORES, scored, output)
        write_table(PREDICTIONS, predicted, predictions[strategy])
