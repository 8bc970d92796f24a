"""Recognise turned objects by a pipeline that is fitted on upright objects that all face the same way."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace

import pyarrow as pa
import pyarrow.compute as pc

from turned.study import DRAWS, POSES, STRATEGIES, TRAINED_UPRIGHT, name_of
from turned.study import STUDY as TURNED
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition.experiment import predict_splits
from visuohaptic.recognition.pipelines import pipeline_of
from visuohaptic.recognition.sequences import gather_pipeline
from visuohaptic.recognition.splits import Split, draw_splits
from visuohaptic.studies.conditions import Planned, plan_study, touches_of_run
from visuohaptic.studies.measuring import Predictions, cell_rows, condition_features, error_rows
from visuohaptic.studies.refusals import REFUSALS
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.studies import STUDY

PIPELINE = "order_free"


def make_trained_upright(step: StepInputs) -> None:
    """Write `tables.STUDY` of each draw of the turns and each strategy."""
    conditions = plan_study(TURNED, step.run).conditions
    planned_of = {planned.condition.name: planned for planned in conditions}
    touches = touches_of_run(step.run)
    upright = planned_of[name_of("none", 0, "full", touches)]
    training = read_table(FEATURES, step.recomputed_features[str(upright.key)])
    parts: list[pa.Table] = []
    for turns in POSES:
        for draw in range(DRAWS if turns != "none" else 0):
            turned = planned_of[name_of(turns, draw, "full", touches)]
            tested = read_table(FEATURES, step.recomputed_features[str(turned.key)])
            name = name_of(turns, draw, TRAINED_UPRIGHT, touches)
            for strategy in STRATEGIES:
                key = (TURNED.name, name, PIPELINE, strategy)
                parts += _measure(key, turned, training, tested, step.run)
    write_table(STUDY, pa.concat_tables(parts), step.outputs[0])


def _measure(
    key: tuple[str, str, str, str],
    planned: Planned,
    training: pa.Table,
    tested: pa.Table,
    run: ExperimentParameters,
) -> Iterator[pa.Table]:
    try:
        rows = [condition_features(planned, table, key[3]) for table in (training, tested)]
        yield from cell_rows(key, predict_turned(planned, rows[0], rows[1], run))
    except REFUSALS as refusal:
        classifiers = planned.parameters.recognition.order_free.classifiers
        yield error_rows(key, classifiers, str(refusal))


def predict_turned(
    planned: Planned, upright: pa.Table, turned: pa.Table, run: ExperimentParameters
) -> Predictions:
    """Train on upright objects and test other objects, turned, in every split.

    `upright` and `turned` are rows of `tables.FEATURES` by one strategy.
    """
    recognition = planned.parameters.recognition
    viewpoints = run.viewpoints.total
    index = turned.column_names.index("viewpoint")
    field = turned.schema.field(index)
    further = pc.add(turned.column("viewpoint"), viewpoints).cast(field.type)
    shifted = turned.set_column(index, field, further)
    both = pa.concat_tables([upright, shifted], promote_options="default")
    sequences = gather_pipeline(both, recognition, PIPELINE, run.seed)
    is_turned = sequences.viewpoint >= viewpoints
    splits = [
        Split(
            split.number,
            split.repeat,
            split.train[~is_turned[split.train]],
            split.test[is_turned[split.test]],
        )
        for split in draw_splits(sequences, recognition.protocol, run.seed)
    ]
    started = time.process_time()
    parts = pipeline_of(PIPELINE, recognition, run.seed)
    predictions = list(predict_splits(sequences, parts, splits, run.seed))
    seconds = time.process_time() - started
    return Predictions(
        replace(sequences, viewpoint=sequences.viewpoint % viewpoints), predictions, seconds
    )
