"""Name known objects by pipeline `learned`, beside `order_free`: ``python -m known_objects.network SET FOLDER``.

`FOLDER` has the features of this study, results/study_features/known_objects of its run on set `SET`, and params.yaml of
the working folder has the parameters of the run. Turns, views and splits are those of the study. No question was written
down before the figures were computed.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from known_objects.new_touches import check_turns, first_touches, mark_turns, split_turns
from known_objects.study import MOST_TOUCHES, STRATEGIES, STUDY
from learned.study import PIPELINES
from visuohaptic.base.arrays import FloatArray
from visuohaptic.evaluation.intervals import SIGNIFICANCE, compare_paired, holm, plain_comparison
from visuohaptic.parameters import ExperimentParameters, read_parameters
from visuohaptic.recognition.experiment import one_thread, predict_splits
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.recognition.pipelines import pipeline_of
from visuohaptic.recognition.sequences import gather_pipeline
from visuohaptic.studies.conditions import plan_study
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table

TOUCHES = (5, MOST_TOUCHES)
MEASURED = Path(__file__).with_name("network.json")


def accuracies(
    turned: Sequence[pa.Table],
    strategy: str,
    touches: int,
    pipeline: str,
    run: ExperimentParameters,
) -> FloatArray:
    """Compute the share of views that are named right, by object in the order of names, (o,).

    `turned` has the features of each turn, and `run` the parameters of the first.
    """
    whole = [first_touches(table, strategy, MOST_TOUCHES) for table in turned]
    shorter = [table.filter(pc.less(table["touch"], touches)) for table in whole]
    parameters = run.recognition.model_copy(update={"touches": touches})
    sequences = gather_pipeline(mark_turns(shorter), parameters, pipeline, run.seed)
    check_turns(sequences, strategy)
    parts = pipeline_of(pipeline, parameters, run.seed)
    right = np.full(len(sequences.labels), np.nan)
    for found in predict_splits(sequences, parts, split_turns(sequences, run.seed), run.seed):
        right[found.split.test] = found.predicted == sequences.labels[found.split.test]
    return np.array(
        [right[sequences.labels == label].mean() for label in range(len(sequences.classes))]
    )


def measure(turned: Sequence[pa.Table], run: ExperimentParameters) -> Iterator[dict[str, Any]]:
    """Yield a row per strategy and number of touches: both accuracies, and their paired comparison."""
    for strategy, touches in product(STRATEGIES, TOUCHES):
        before, after = (accuracies(turned, strategy, touches, name, run) for name in PIPELINES)
        compared = compare_paired(after, before, np.ones(len(before)), IntervalParameters())
        yield {
            "strategy": strategy,
            "touches": touches,
            **dict(zip(PIPELINES, (before.mean(), after.mean()), strict=True)),
            **plain_comparison(compared),
        }


def count_shown(measured: Mapping[str, Sequence[Mapping[str, Any]]]) -> tuple[int, int]:
    """Return how many gains stand after Holm's correction for all rows of all sets, and the number of rows."""
    every = [row for rows in measured.values() for row in rows]
    corrected = holm([row["p_value"] for row in every])
    shown = (
        row["difference"]["mean"] > 0 and value < SIGNIFICANCE
        for row, value in zip(every, corrected, strict=True)
    )
    return sum(shown), len(every)


def main() -> None:
    """Write the accuracies of a set into the JSON file of all sets."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("set", help="name of the set of objects, such as paper")
    parser.add_argument("folder", type=Path, help="results/study_features/known_objects of a run")
    arguments = parser.parse_args()
    planned = plan_study(STUDY, read_parameters("params.yaml")).conditions
    turned = [read_table(FEATURES, arguments.folder / f"{one.key}.parquet") for one in planned]
    measured = json.loads(MEASURED.read_text(encoding="utf-8")) if MEASURED.exists() else {}
    with one_thread():
        measured[arguments.set] = [*measure(turned, planned[0].parameters)]
    MEASURED.write_text(json.dumps(measured, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
