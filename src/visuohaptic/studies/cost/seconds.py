"""Measure the processor time of one recognition under each setting, without imports and reading of files."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from copy import copy
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

import cv2
import numpy as np
import pyarrow as pa
from threadpoolctl import threadpool_limits

from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import Surface, object_of, read_surface, usable_meshes
from visuohaptic.io.phase_files import Tables
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.phases import OF_OBJECT, Phase
from visuohaptic.pipeline import blocks_of, run_phase, tables_for_next
from visuohaptic.recognition.model import RecognitionModel, fit_model
from visuohaptic.recognition.voting import evenly_spaced_subsets
from visuohaptic.studies.conditions import Planned, plan_study, training_key
from visuohaptic.studies.cost.settings import FRONTIER, Setting, frontier_settings
from visuohaptic.studies.measuring import condition_features, features_by_key
from visuohaptic.studies.refusals import REFUSALS
from visuohaptic.studies.study import StepInputs, Study
from visuohaptic.tables.schema import build_rows, write_table
from visuohaptic.tables.studies import COST_PARTS, COST_SECONDS

FRONTIER_ROUNDS = 1
"""Rounds of study `frontier`, which every run contains. Its intervals come from the differences between objects: a second
round narrows them by 2 %."""

FOLDS = 2
"""Folds of the certainty of timed models: the time of an answer depends on the number of scores, not on the folds."""

LOOK = OF_OBJECT[0]
"""The phase that renders views and computes fixations."""

Row = dict[str, Any]
Seconds = dict[str, float]
"""Processor seconds by column of `tables.COST_SECONDS`."""


@dataclass(frozen=True)
class FittedSetting:
    """A setting, its parameters, and a model that was trained for the setting.

    `looking` are the parameters of phase `LOOK`. Settings that differ only in the number of fixations share them.
    """

    setting: Setting
    parameters: ExperimentParameters
    model: RecognitionModel
    looking: ExperimentParameters


def make_frontier_seconds(step: StepInputs) -> None:
    """Write `tables.COST_SECONDS` of study `frontier`."""
    write_seconds(step, FRONTIER, frontier_settings(step.run), FRONTIER_ROUNDS)


def write_seconds(step: StepInputs, study: Study, settings: Sequence[Setting], rounds: int) -> None:
    """Write `tables.COST_SECONDS` of settings; setting i belongs to condition i of the study."""
    fitted = fit_settings(study, settings, step)
    meshes = usable_meshes(step.inputs["meshes"]) if fitted else ()
    surfaces = {object_of(mesh): read_surface(mesh) for mesh in meshes}
    write_table(COST_SECONDS, measure_seconds(surfaces, fitted, rounds), step.outputs[0])


def fit_settings(
    study: Study, settings: Sequence[Setting], step: StepInputs
) -> list[FittedSetting]:
    """Train a model per setting; settings whose training is refused are left out.

    Settings that differ only in viewpoints or strategy share a model. The time of a prediction depends on the model's
    size, and the size does not depend on the strategy of the training touches.
    """
    run = step.run
    features = features_by_key(step.inputs["features"], step.recomputed_features, step.objects)
    conditions = plan_study(study, run).conditions
    models: dict[tuple[str, str], RecognitionModel | None] = {}
    settings_with_model: list[FittedSetting] = []
    for setting, planned in zip(settings, conditions, strict=True):
        key = _model_key(planned)
        if models.get(key) is None:
            models[key] = fit_setting(setting, planned, features(planned.key), run.seed)
        if model := models[key]:
            fitted = FittedSetting(setting, planned.parameters, model, planned.parameters)
            settings_with_model.append(fitted)
    return share_looks(settings_with_model)


def share_looks(settings: Sequence[FittedSetting]) -> list[FittedSetting]:
    """Set `looking` to the parameters with the most fixations among settings with otherwise equal looks.

    A smaller number of fixations is a prefix of a larger number, so the touches stay the same.
    """
    by_look: dict[str, list[ExperimentParameters]] = {}
    for fitted in settings:
        by_look.setdefault(_look_key(fitted.parameters), []).append(fitted.parameters)
    most = {
        key: max(parameters, key=lambda each: each.attention.fixations)
        for key, parameters in by_look.items()
    }
    return [replace(fitted, looking=most[_look_key(fitted.parameters)]) for fitted in settings]


def _look_key(parameters: ExperimentParameters) -> str:
    """Return the parameters of phase `LOOK`, without the number of fixations, as JSON."""
    attention = parameters.attention.model_copy(update={"fixations": 0})
    values = LOOK.written_values(parameters.model_copy(update={"attention": attention}))
    return json.dumps(values, sort_keys=True)


def _model_key(planned: Planned) -> tuple[str, str]:
    """Return the key of the features, and the parameters without the strategies."""
    parameters = planned.parameters
    probing = parameters.probing.model_copy(update={"strategies": ()})
    without_strategies = parameters.model_copy(update={"probing": probing})
    return training_key(replace(planned, parameters=without_strategies))


def fit_setting(
    setting: Setting, planned: Planned, features: pa.Table | str, seed: int
) -> RecognitionModel | None:
    """Train the model of a setting. Returns None if the training is refused."""
    try:
        rows = condition_features(planned, features, setting.strategy)
        recognition = planned.parameters.recognition
        return fit_model(rows, setting.pipeline, setting.classifier, recognition, seed, FOLDS)
    except REFUSALS:
        return None


def measure_seconds(
    surfaces: Mapping[str, Surface], settings: Sequence[FittedSetting], rounds: int
) -> pa.Table:
    """Measure the seconds of recognitions of the same objects under each setting.

    The settings take turns, so that other work on the machine affects all equally.

    Parameters
    ----------
    surfaces : mapping of str to Surface
        Surfaces by ``class/name``.
    settings : sequence of FittedSetting
        The settings to time.
    rounds : int
        Recognitions per object and setting, each from other viewpoints.

    Returns
    -------
    pyarrow.Table
        `tables.COST_SECONDS` with one row per recognition. Refused recognitions have no row; an example is a view
        with too few places to touch.
    """
    distinct = {fitted.setting.written_changes: fitted for fitted in settings}.values()
    rows: list[Row] = []
    with threadpool_limits(limits=1), ExitStack() as afterwards:
        afterwards.callback(cv2.setNumThreads, cv2.getNumThreads())
        cv2.setNumThreads(1)
        # Warm up: the first call fills caches per process and per surface.
        for key, surface in surfaces.items():
            time_object(key, surface, list(distinct), 0)
        for turn, (key, surface) in product(range(rounds), surfaces.items()):
            rows += time_object(key, surface, settings, turn)
    return build_rows(COST_SECONDS, rows)


def time_object(
    key: str, surface: Surface, settings: Sequence[FittedSetting], turn: int
) -> list[Row]:
    """Time one recognition under each setting; work that settings share runs, and is timed, once."""
    prepared = prepare_surface(surface)
    touched: list[tuple[FittedSetting, pa.Table, Seconds]] = []
    for fitted in settings:
        choices = evenly_spaced_subsets(
            fitted.parameters.viewpoints.total, fitted.setting.viewpoints
        )
        # Each turn skips two choices of viewpoints: neighbouring choices see almost the same.
        subject = Subject(key, lambda: prepared.caster, choices[3 * turn % len(choices)].tolist())
        with suppress(*REFUSALS):
            touched.append((fitted, *look_and_touch(subject, prepared, fitted)))
    # The first prediction after other work takes a quarter longer (cold processor cache), so make one that is not
    # timed.
    for fitted, features, _ in touched[:1]:
        prediction_seconds(fitted, features)
    return [
        _row(fitted, seconds | {"seconds_classify": predicting}, key, turn)
        for fitted, features, seconds in touched
        if (predicting := prediction_seconds(fitted, features)) is not None
    ]


def _row(fitted: FittedSetting, seconds: Seconds, key: str, turn: int) -> Row:
    verbs = (*(phase.verb for phase in OF_OBJECT), "classify")
    names = (fitted.setting.family, fitted.setting.name, key, turn)
    whole = sum(seconds[f"seconds_{verb}"] for verb in verbs)
    return {**dict(zip(COST_SECONDS.keys, names, strict=True)), "seconds": whole, **seconds}


def prediction_seconds(fitted: FittedSetting, features: pa.Table) -> float | None:
    """Return the processor seconds of a prediction; None if the model refuses the touches."""
    start = time.process_time()
    try:
        fitted.model.recognise(features)
    except REFUSALS:
        return None
    return time.process_time() - start


def look_and_touch(
    subject: Subject, prepared: Stage, fitted: FittedSetting
) -> tuple[pa.Table, Seconds]:
    """Run the phases of an object. Returns `tables.FEATURES`, and the seconds of each part.

    The object's key only seeds the random generators.
    """
    stage, features = prepared, list[pa.Table]()
    for block in blocks_of(subject, fitted.looking):
        for phase in OF_OBJECT:
            parameters = fitted.looking if phase is LOOK else fitted.parameters
            stage = stage.next_stage(phase, block, parameters)
        features.append(stage.tables["features"])
    return pa.concat_tables(features), dict(stage.seconds)


class TimedCaster(RayCaster):
    """A ray caster that sums the processor seconds of its casts."""

    seconds = 0.0

    def first_hits(self, *rays: Any) -> Any:
        """Cast rays as `RayCaster` does."""
        start = time.process_time()
        hits = super().first_hits(*rays)
        self.seconds += time.process_time() - start
        return hits


@dataclass(frozen=True)
class Stage:
    """An object after a phase: its ray caster, the tables, and the seconds of all phases so far.

    `next_stages` caches pairs of viewpoints and parameters, and the stage that the next phase led to.
    """

    caster: TimedCaster
    tables: Tables
    seconds: Seconds
    next_stages: list[tuple[Any, Stage]] = field(default_factory=list)

    def next_stage(self, phase: Phase, block: Subject, parameters: ExperimentParameters) -> Stage:
        """Run a phase, once per combination of viewpoints and parameters."""
        key = block.viewpoints, phase.values(parameters)
        for known, stage in self.next_stages:
            if known == key:
                return stage
        # A copy, because the caster caches properties of the surface at first use: no setting may profit from the
        # cache of another setting.
        caster, seconds = copy(self.caster), dict(self.seconds)
        with _timed(seconds, phase.verb):
            timed = replace(block, find_caster=lambda: caster)
            done = run_phase(phase, timed, self.tables, parameters)
            if phase.verb == "look" and done.needs_views:
                for part, name in (("render", "rendered"), ("attend", "attended_views")):
                    with _timed(seconds, part):
                        getattr(done, name)
            tables = self.tables | tables_for_next(phase, done)
        if phase.verb == "touch":
            seconds["seconds_cast"] += caster.seconds - self.caster.seconds
        stage = Stage(caster, tables, seconds)
        self.next_stages.append((key, stage))
        return stage


def prepare_surface(surface: Surface) -> Stage:
    """Build the ray caster of a surface; its seconds belong to phase `LOOK`."""
    seconds = {name: 0.0 for name, _ in COST_PARTS}
    with _timed(seconds, "look"):
        caster = TimedCaster(surface)
        # The first ray searches for faces that lie on each other.
        caster.first_hits(np.zeros((1, 3)), np.ones((1, 3)))
    return Stage(caster, {}, seconds)


@contextmanager
def _timed(seconds: Seconds, name: str | None) -> Iterator[None]:
    start = time.process_time()
    yield
    taken = time.process_time() - start
    seconds[f"seconds_{name}"] = seconds.get(f"seconds_{name}", 0.0) + taken
