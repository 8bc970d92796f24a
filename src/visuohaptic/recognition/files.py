"""From the feature table to the score and prediction tables."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pyarrow.compute as pc

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.sequences import classes_of_two
from visuohaptic.tables.phases import FEATURES, PREDICTIONS, SCORES
from visuohaptic.tables.schema import read_table, write_table


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
    chosen = table.filter(pc.equal(table.column("strategy"), strategy))
    if not chosen.num_rows:
        found = sorted(pc.unique(table.column("strategy")).to_pylist())
        raise RecognitionError(f"no touch was made by {strategy}; there are touches by {found}.")
    scored, predicted = run_pipeline(classes_of_two(chosen), parameters, seed, pipeline)
    write_table(SCORES, scored, scores)
    write_table(PREDICTIONS, predicted, predictions)
