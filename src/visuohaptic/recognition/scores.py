"""From feature tables to score and prediction tables, file to file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.experiment import run_pipeline
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.tables import FEATURES, PREDICTIONS, SCORES, read_table, write_table


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

    Parameters
    ----------
    features : sequence of path
        The whole feature table, in any order.
    scores, predictions : path
        The Parquet files to write.
    pipeline, strategy : str
        Which pipeline, on the touches of which strategy.
    parameters : RecognitionParameters
        Section `recognition`.
    seed : int
        The experiment's seed.

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


def classes_of_two(features: pa.Table) -> pa.Table:
    """Leave out the classes that have a single object: nothing could train while it is tested.

    Parameters
    ----------
    features : pyarrow.Table
        Rows of `tables.FEATURES`.

    Returns
    -------
    pyarrow.Table
        The rows of classes with two objects or more.
    """
    objects = features.group_by(["class", "object"]).aggregate([])
    counts = objects.group_by("class").aggregate([("object", "count")])
    enough = counts.filter(pc.greater_equal(counts.column("object_count"), 2)).column("class")
    return features.filter(pc.is_in(features.column("class"), enough.combine_chunks()))
