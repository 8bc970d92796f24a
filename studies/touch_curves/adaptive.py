"""The adaptive strategy: each split chooses its touches by its training objects."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa

from touch_curves.choosing import choose_features, gather_candidates
from touch_curves.study import STUDY as TOUCH_CURVES
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
from visuohaptic.pipeline import run
from visuohaptic.recognition.experiment import gather_pipeline, split_runner
from visuohaptic.recognition.sequences import classes_of_two
from visuohaptic.studies.conditions import CLASSIFIER, Planned, plan_study
from visuohaptic.studies.measuring import (
    REFUSALS,
    Predictions,
    cell_rows,
    error_rows,
    predict_objects,
)
from visuohaptic.studies.study import StepInputs
from visuohaptic.tables.phases import FEATURES
from visuohaptic.tables.schema import read_table, write_table
from visuohaptic.tables.studies import STUDY
from visuohaptic.touches.choosing import in_reach
from visuohaptic.touches.touching import touch_tables

if TYPE_CHECKING:
    from touch_curves.choosing import Candidates
    from visuohaptic.recognition.experiment import Answer
    from visuohaptic.recognition.splits import Split

CANDIDATES = 256
"""Places of an object among which `adaptive` chooses where a viewpoint sees them."""


def make_candidates(step: StepInputs) -> None:
    """Touch objects wherever `adaptive` may choose to, in reach where places are replaced: rows of `tables.FEATURES`."""
    features, parameters = [], step.run
    for mesh in usable_meshes(step.inputs["meshes"]):
        subject = Subject.of_mesh(object_of(mesh), mesh)
        caster = subject.caster
        generator = spawn_generator(parameters.seed, "candidates", subject.key)
        crowd = spread_far(caster.surface, CANDIDATES, generator)
        outwards = orient_outwards(caster, crowd.points, crowd.normals)
        places = ProbingLocations(crowd.points, outwards, crowd.faces)
        parts = [
            candidate_table(Viewpoint(subject.key, number, caster, camera), places)
            for number, camera in enumerate(place_cameras(parameters.viewpoints))
        ]
        located = pa.concat_tables(parts).combine_chunks()
        if parameters.probing.unreachable == "replace":
            located = located.filter(pa.array(in_reach(caster, located, parameters.sensor)))
        scene, seed = parameters.scene, parameters.seed
        touches, _ = touch_tables(caster, located, parameters.sensor, scene, seed)
        features.append(run(subject, parameters, {"touches": touches})["features"])
    write_table(FEATURES, pa.concat_tables(features), step.outputs[0])


def make_adaptive_rows(step: StepInputs) -> None:
    """Write `tables.STUDY` of the study's conditions on touches that `adaptive` chooses."""
    planned = plan_study(TOUCH_CURVES, step.run).conditions
    features = read_table(FEATURES, step.inputs["tables"])
    rows = adaptive_rows(features, planned, step.wildcards["pipeline"])
    write_table(STUDY, pa.concat_tables(rows), step.outputs[0])


def adaptive_rows(
    features: pa.Table, planned: Sequence[Planned], pipeline: str
) -> Iterator[pa.Table]:
    """Choose each split's touches by its training objects, then train and test.

    `features` are those that `make_candidates` writes; the conditions differ in the number of
    touches. Yields `tables.STUDY` of each condition, by strategy ``adaptive``.
    """
    chooser = cache(partial(_Chooser, features, planned, pipeline))
    for one in planned:
        key = (TOUCH_CURVES.name, one.condition.name, pipeline, "adaptive")
        try:
            yield from cell_rows(key, chooser().predict_objects(one.parameters))
        except REFUSALS as refusal:
            yield error_rows(key, (CLASSIFIER,), str(refusal))


class _Chooser:
    """Touches that are chosen once a split, as many as the longest sequence needs."""

    def __init__(self, features: pa.Table, planned: Sequence[Planned], pipeline: str) -> None:
        features = classes_of_two(features)
        # The columns that a pipeline takes are those that it takes of one touch a sequence.
        first = select(features, touch=0)
        single = planned[0].parameters.recognition.model_copy(update={"touches": 1})
        best, names = (
            gather_pipeline(first, single, name).feature_names for name in ("best", pipeline)
        )
        self._candidates: Candidates = gather_candidates(features, best)
        self._used = [best.index(name) for name in names]
        self._most = max(one.parameters.recognition.touches or 1 for one in planned)
        self._chosen: dict[tuple[int, ...], np.ndarray] = {}
        self._pipeline = pipeline

    def predict_objects(self, parameters: ExperimentParameters) -> Predictions:
        """Train and test every split on its own touches."""
        whole, recognition = self._candidates.sequences, parameters.recognition

        def answer(split: Split, generator: np.random.Generator) -> Iterator[Answer]:
            key = tuple(split.test.tolist())
            if key not in self._chosen:
                self._chosen[key] = choose_features(self._candidates, split, self._most, parameters)
            sequences = replace(
                whole,
                features=self._chosen[key][:, : recognition.touches, self._used],
                feature_names=tuple(whole.feature_names[column] for column in self._used),
            )
            runner = split_runner(sequences, recognition, parameters.seed, self._pipeline)
            return runner(split, generator)

        return predict_objects(whole, parameters, self._pipeline, parameters.seed, answer)
