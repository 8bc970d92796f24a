"""How well each object is named after one touch, two, and so on, by one strategy."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa

from visuohaptic.errors import RecognitionError
from visuohaptic.recognition.adaptive import Candidates, choose_sequences, gather_candidates
from visuohaptic.recognition.descriptors import describe_sequences, draw_waves
from visuohaptic.recognition.experiment import (
    Answer,
    AnswerSplit,
    gather_pipeline,
    run_best_split,
    run_paper_split,
    run_pipeline,
    run_sequences,
)
from visuohaptic.recognition.parameters import RecognitionParameters
from visuohaptic.recognition.sequences import TouchSequences, classes_of_two
from visuohaptic.recognition.splits import Split
from visuohaptic.recognition.summary import object_accuracies, select
from visuohaptic.seeds import spawn_generator
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import build_table, read_table, write_table
from visuohaptic.tables.studies import CURVES

CLASSIFIER = "support_vector_machine"
"""The paper's best; one is enough to tell strategies apart."""

Run = Callable[[RecognitionParameters], tuple[pa.Table, pa.Table]]


def object_curves(
    features: pa.Table,
    parameters: RecognitionParameters,
    focus_radius: float,
    seed: int,
    pipeline: str,
    touches: Sequence[int],
) -> pa.Table:
    """Train and test with the first touch alone, the first two, and so on.

    Parameters
    ----------
    features : pyarrow.Table
        Rows of `tables.FEATURES` of one strategy, at least as many touches a sequence as asked for;
        of strategy ``adaptive`` the candidates of each viewpoint.
    parameters : RecognitionParameters
        Section `recognition`; of the classifiers `CLASSIFIER` alone is used, and its number of
        touches is not.
    focus_radius : float
        How far apart `adaptive` keeps touches, object radii.
    seed : int
        The experiment's seed; every strategy and every number of touches has the same splits.
    pipeline : str
        ``paper`` or ``best``.
    touches : sequence of int
        Numbers of touches.

    Returns
    -------
    pyarrow.Table
        `tables.CURVES`.

    Raises
    ------
    RecognitionError
        If the features don't allow the experiment.
    """
    if not features.num_rows:
        raise RecognitionError("The features hold no touches; at least two objects are needed.")
    strategy = features.column("strategy")[0].as_py()
    features = classes_of_two(features)
    alone = parameters.model_copy(
        update={
            "classifiers": (CLASSIFIER,),
            "best": parameters.best.model_copy(update={"classifiers": (CLASSIFIER,)}),
        }
    )
    runs: Run = lambda taken: run_pipeline(features, taken, seed, pipeline)  # noqa: E731
    if strategy == "adaptive":
        runs = _adaptive_runs(features, alone, focus_radius, seed, pipeline, max(touches))
    parts = []
    for count in touches:
        _, predictions = runs(alone.model_copy(update={"touches": count}))
        parts.append(_rows(predictions, pipeline, strategy, count))
    return pa.concat_tables(parts)


def make_curves(
    features: Sequence[str | Path],
    output: str | Path,
    pipeline: str,
    strategy: str,
    parameters: RecognitionParameters,
    focus_radius: float,
    touches: int,
    seed: int,
) -> None:
    """Make the table of one pipeline and strategy.

    Parameters
    ----------
    features : sequence of path
        The whole table of long sequences.
    output : path
        The Parquet file to write.
    pipeline, strategy : str
        Which pipeline, on the touches of which strategy.
    parameters : RecognitionParameters
        Section `recognition`.
    focus_radius : float
        How far apart `adaptive` keeps touches, object radii.
    touches : int
        The longest sequences.
    seed : int
        The experiment's seed.
    """
    chosen = select(read_table(FEATURES, features), strategy=strategy)
    counts = range(1, touches + 1)
    table = object_curves(chosen, parameters, focus_radius, seed, pipeline, counts)
    write_table(CURVES, table, output)


def _rows(predictions: pa.Table, pipeline: str, strategy: str, touches: int) -> pa.Table:
    objects, accuracy, weights = object_accuracies(predictions)
    return build_table(
        CURVES,
        {
            "pipeline": pipeline,
            "strategy": strategy,
            "classifier": CLASSIFIER,
            "touches": touches,
            "class": [category for category, _ in objects],
            "object": [name for _, name in objects],
            "accuracy": accuracy,
            "weight": weights,
        },
    )


def _adaptive_runs(
    features: pa.Table,
    parameters: RecognitionParameters,
    focus_radius: float,
    seed: int,
    pipeline: str,
    touches: int,
) -> Run:
    """Give runs in which every split has touches of its own, chosen when first asked for."""
    # The columns that the pipeline takes are those that it takes of one touch a sequence.
    first = select(features, touch=0)
    names = gather_pipeline(first, parameters.model_copy(update={"touches": 1}), pipeline)
    best = gather_pipeline(first, parameters.model_copy(update={"touches": 1}), "best")
    candidates = gather_candidates(features, best.feature_names)
    used = [best.feature_names.index(name) for name in names.feature_names]
    waves = draw_waves(parameters.best, spawn_generator(seed, "recognition", "waves"))
    chosen: dict[tuple[int, ...], np.ndarray] = {}

    def sequences_of(split: Split, count: int) -> TouchSequences:
        key = tuple(split.test.tolist())
        if key not in chosen:
            generator = spawn_generator(seed, "adaptive", *key)
            chosen[key] = choose_sequences(
                candidates, split, touches, parameters.best, focus_radius, generator
            )
        return _with_features(candidates, chosen[key][:, :count], used)

    def answering(taken: RecognitionParameters) -> AnswerSplit:
        count = taken.touches or touches

        def answer(split: Split, generator: np.random.Generator) -> Iterator[Answer]:
            sequences = sequences_of(split, count)
            if pipeline == "paper":
                return run_paper_split(sequences, split, taken, generator)
            described = describe_sequences(
                sequences.features, sequences.feature_names, waves, taken.best
            )
            return run_best_split(sequences, described, split, taken, generator)

        return answer

    return lambda taken: run_sequences(
        candidates.sequences, "adaptive", taken, seed, pipeline, answering(taken)
    )


def _with_features(
    candidates: Candidates, rows: np.ndarray, columns: Sequence[int]
) -> TouchSequences:
    sequences = candidates.sequences
    return TouchSequences(
        candidates.features[rows][:, :, columns],
        tuple(sequences.feature_names[column] for column in columns),
        sequences.objects,
        sequences.classes,
        sequences.object_index,
        sequences.viewpoint,
    )
