"""From the feature table to the score and prediction tables."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from pathlib import Path

from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.sequences import take_strategy
from visuohaptic.tables.phases import FEATURES, PREDICTIONS, SCORES
from visuohaptic.tables.schema import read_table, write_table

logger = logging.getLogger(__name__)


def make_scores(
    features: Sequence[str | Path],
    scores: str | Path,
    predictions: str | Path,
    pipeline: str,
    strategy: str,
    parameters: RecognitionParameters,
    seed: int,
) -> None:
    """Make the score and prediction tables of one pipeline and strategy.

    Raises `RecognitionError` if the table has no touch of the strategy, or not what the experiment
    needs.
    """
    # With scikit-learn, which whoever reads the list of phases does not need.
    from visuohaptic.recognition.experiment import run_pipeline

    table, left_out = take_strategy(read_table(FEATURES, features), strategy, parameters.touches)
    for sentence in left_out:
        logger.warning(sentence)
    scored, predicted = run_pipeline(table, parameters, seed, pipeline)
    write_table(SCORES, scored, scores)
    write_table(PREDICTIONS, predicted, predictions)
