"""From the feature table to the score and prediction tables."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from pathlib import Path

import pyarrow.compute as pc

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.sequences import classes_of_two, whole_sequences
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

    Raises
    ------
    RecognitionError
        If the table has no touch of the strategy, or not what the experiment needs.
    """
    table = read_table(FEATURES, features)
    if strategy not in table.column("strategy").unique().to_pylist():
        found = sorted(pc.unique(table.column("strategy")).to_pylist())
        raise RecognitionError(f"no touch was made by {strategy}; there are touches by {found}.")
    whole, left_out = whole_sequences(table, parameters.touches)
    for sentence in left_out:
        logger.warning(sentence)
    chosen = whole.filter(pc.equal(whole.column("strategy"), strategy))
    if not chosen.num_rows:
        raise RecognitionError(
            f"No viewpoint of any object has {parameters.touches} touches (recognition.touches)."
        )
    scored, predicted = run_pipeline(classes_of_two(chosen), parameters, seed, pipeline)
    write_table(SCORES, scored, scores)
    write_table(PREDICTIONS, predicted, predictions)
