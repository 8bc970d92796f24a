"""Measure learning policies such as `adaptive`: each split trains the policy, which then chooses the touches."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import pyarrow as pa

import touch_curves.choosing  # noqa: F401 - registers `adaptive`
from touch_curves.learning import choose_in_splits, gather_candidates
from touch_curves.study import STUDY as TOUCH_CURVES
from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.evaluation.summary import select
from visuohaptic.fixations.attended_views import Viewpoint
from visuohaptic.fixations.locations import candidate_table
from visuohaptic.fixations.places import ProbingLocations
from visuohaptic.fixations.strategies.farthest_point import spread_far
from visuohaptic.fixations.viewpoints import place_cameras
from visuohaptic.geometry.orientation import orient_outwards
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import object_of, usable_meshes
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pipeline import run as run_phases
from visuohaptic.recognition.experiment import SplitPrediction, predict_split
from visuohaptic.recognition.pipelines import pipeline_of
from visuohaptic.recognition.sequences import TouchSequences, classes_of_two, gather_pipeline
from visuohaptic.recognition.splits import Split, draw_splits
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS, Planned, plan_study
from visuohaptic.studies.learning_policies import LEARNING_POLICIES, LearningPolicy
from visuohaptic.studies.measuring import Predictions, cell_rows, error_rows
from visuohaptic.studies.refusals import REFUSALS
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.studies import STUDY
from visuohaptic.touches.choosing import in_reach
from visuohaptic.touches.touch_table import touch_part

CANDIDATES = 256
"""Candidates per object for `adaptive`; a viewpoint has the candidates that it sees."""

logger = logging.getLogger(__name__)


def make_candidates(step: StepInputs) -> None:
    """Write the tables of `touch_candidates` of all objects."""
    features = [
        touch_candidates(Subject.of_mesh(object_of(mesh), mesh), step.run)
        for mesh in usable_meshes(step.inputs["meshes"])
    ]
    write_table(FEATURES, pa.concat_tables(features), step.outputs[0])


def touch_candidates(subject: Subject, parameters: ExperimentParameters) -> pa.Table:
    """Touch an object at all candidates of `adaptive` in reach, from every viewpoint; return `tables.FEATURES`.

    With ``probing.unreachable`` ``keep`` candidates out of reach are touched too.
    """
    caster = subject.caster
    generator = spawn_generator(parameters.seed, "candidates", subject.key)
    spread = spread_far(caster.surface, CANDIDATES, generator)
    outwards = orient_outwards(caster, spread.points, spread.normals)
    locations = ProbingLocations(spread.points, outwards, spread.faces)
    parts = [
        candidate_table(Viewpoint(subject.key, number, caster, camera), locations)
        for number, camera in enumerate(place_cameras(parameters.viewpoints))
    ]
    located = pa.concat_tables(parts).combine_chunks()
    if parameters.probing.unreachable != "keep":
        located = located.filter(pa.array(in_reach(caster, located, parameters.sensor)))
    scene, seed = parameters.scene, parameters.seed
    touches, _ = touch_part(caster, located, parameters.sensor, scene, seed)
    return run_phases(subject, parameters, {"touches": touches})["features"]


def make_adaptive_rows(step: StepInputs) -> None:
    """Write `tables.STUDY` of the study's conditions for touches of each learning policy, first `adaptive`."""
    planned = plan_study(TOUCH_CURVES, step.run).conditions
    features = read_table(FEATURES, step.inputs["tables"])
    rows = [
        part
        for policy in LEARNING_POLICIES
        for part in learning_rows(policy, features, planned, step.wildcards["pipeline"])
    ]
    write_table(STUDY, pa.concat_tables(rows), step.outputs[0])


def learning_rows(
    policy: LearningPolicy, features: pa.Table, planned: Sequence[Planned], pipeline: str
) -> Iterator[pa.Table]:
    """Choose the touches of each split by a policy, then train and test; yield `tables.STUDY` per condition.

    `features` is the table of `make_candidates`. The conditions `planned` differ only in the number of touches. Column
    ``strategy`` has the name of the policy.
    """
    keys = [(TOUCH_CURVES.name, each.condition.name, pipeline, policy.name) for each in planned]
    classifiers = (HEADLINE_CLASSIFIERS[pipeline],)
    try:
        chosen = choose_for_splits(policy, features, planned)
    except REFUSALS as refusal:
        logger.warning("%s", refusal)
        yield from (error_rows(key, classifiers, str(refusal)) for key in keys)
        return
    for key, condition in zip(keys, planned, strict=True):
        try:
            yield from cell_rows(key, predict_chosen(chosen, condition.parameters, pipeline))
        except REFUSALS as refusal:
            yield error_rows(key, classifiers, str(refusal))


@dataclass(frozen=True)
class ChosenTouches:
    """The touches that a policy chose in each split; t is the largest number of touches of the conditions.

    Attributes
    ----------
    sequences : TouchSequences
        The s sequences without features.
    first : pyarrow.Table
        Rows of the first candidate of each sequence, from which the columns of a pipeline are read.
    splits : list of Split
        The splits.
    features : list of ndarray of shape (s, t, k)
        Features of the chosen touches, per split.
    """

    sequences: TouchSequences
    first: pa.Table
    splits: list[Split]
    features: list[FloatArray]


def choose_for_splits(
    policy: LearningPolicy, features: pa.Table, planned: Sequence[Planned]
) -> ChosenTouches:
    """Choose touches in every split; the conditions `planned` differ only in the number of touches."""
    run = planned[0].parameters
    most = max(condition.parameters.recognition.touches or 1 for condition in planned)
    draw = partial(draw_splits, parameters=run.recognition.protocol, seed=run.seed)
    return choose_touches(policy, classes_of_two(features), run, most, draw)


def choose_touches(
    policy: LearningPolicy,
    features: pa.Table,
    run: ExperimentParameters,
    touches: int,
    draw: Callable[[TouchSequences], list[Split]],
) -> ChosenTouches:
    """Choose so many touches per sequence in each of the splits that `draw` returns for the sequences."""
    first = select(features, touch=0)
    candidates = gather_candidates(features, _columns_of(first, run, "order_free"))
    splits = draw(candidates.sequences)
    rows_of_splits = choose_in_splits(policy, candidates, splits, touches, run)
    chosen = [candidates.features[rows] for rows in rows_of_splits]
    return ChosenTouches(candidates.sequences, first, splits, chosen)


def predict_chosen(chosen: ChosenTouches, run: ExperimentParameters, pipeline: str) -> Predictions:
    """Train and test a pipeline in every split on the touches that were chosen in the split."""
    started = time.process_time()
    names = _columns_of(chosen.first, run, pipeline)
    columns = [chosen.sequences.feature_names.index(name) for name in names]
    parts = pipeline_of(pipeline, run.recognition, run.seed)
    predictions: list[SplitPrediction] = []
    for split, features in zip(chosen.splits, chosen.features, strict=True):
        touched = features[:, : run.recognition.touches, columns]
        sequences = replace(chosen.sequences, features=touched, feature_names=names)
        predictions += predict_split(sequences, parts.rows(sequences), parts, split, run.seed)
    return Predictions(chosen.sequences, predictions, time.process_time() - started)


def _columns_of(first: pa.Table, run: ExperimentParameters, pipeline: str) -> tuple[str, ...]:
    """Return the columns of candidates that a pipeline uses; `first` has one touch per sequence."""
    single = run.recognition.model_copy(update={"touches": 1})
    return gather_pipeline(first, single, pipeline).feature_names
