"""Run time of one recognition under each setting, without imports and files."""

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
from visuohaptic.pipeline import VIEWPOINTS_AT_ONCE, run_phase, tables_for_next
from visuohaptic.recognition.model import RecognitionModel, fit_model
from visuohaptic.recognition.voting import evenly_spaced_subsets
from visuohaptic.studies.conditions import Planned, plan_study, training_key
from visuohaptic.studies.cost.settings import FRONTIER, Setting, frontier_settings
from visuohaptic.studies.measuring import condition_features, features_by_key
from visuohaptic.studies.refusals import REFUSALS
from visuohaptic.studies.study import StepInputs, Study
from visuohaptic.tables.schema import build_rows, write_table
from visuohaptic.tables.studies import COST_PARTS, COST_SECONDS

FRONTIER_ROUNDS = 2
"""Instead of `cost.rounds`, as the frontier is a part of every run."""

LOOK = OF_OBJECT[0]
"""The phase that looks."""

Row = dict[str, Any]
Seconds = dict[str, float]
"""Of the processor, by the names of `COST_PARTS`, and of a phase that has none there."""


@dataclass(frozen=True)
class FittedSetting:
    """A setting with its parameters and a model that was trained for it.

    `looking` has the parameters of the look, which finds the most fixations of all settings that look alike.
    """

    setting: Setting
    parameters: ExperimentParameters
    model: RecognitionModel
    looking: ExperimentParameters


def make_frontier_seconds(step: StepInputs) -> None:
    """Time every setting of the frontier side by side: `tables.COST_SECONDS`."""
    write_seconds(step, FRONTIER, frontier_settings(step.run), FRONTIER_ROUNDS)


def write_seconds(step: StepInputs, study: Study, settings: Sequence[Setting], rounds: int) -> None:
    """Time every setting of a study, one for each of its conditions, side by side: `tables.COST_SECONDS`."""
    fitted = fit_settings(study, settings, step)
    meshes = usable_meshes(step.inputs["meshes"]) if fitted else ()
    surfaces = {object_of(mesh): read_surface(mesh) for mesh in meshes}
    write_table(COST_SECONDS, measure_seconds(surfaces, fitted, rounds), step.outputs[0])


def fit_settings(
    study: Study, settings: Sequence[Setting], step: StepInputs
) -> list[FittedSetting]:
    """Train each setting that can be; settings that differ only in viewpoints or in strategy share a model.

    The time of an answer depends on the model's size, which the strategy of the training touches does not change.
    """
    run, features = step.run, features_by_key(step.inputs["features"], step.made, step.objects)
    planned = plan_study(study, run).conditions
    models: dict[tuple[str, str], RecognitionModel | None] = {}
    found: list[FittedSetting] = []
    for setting, one in zip(settings, planned, strict=True):
        asked = _model_key(one)
        if models.get(asked) is None:
            models[asked] = fit_setting(setting, one, features(one.key), run.seed)
        if model := models[asked]:
            found.append(FittedSetting(setting, one.parameters, model, one.parameters))
    return share_looks(found)


def share_looks(settings: Sequence[FittedSetting]) -> list[FittedSetting]:
    """Assign one look to settings that look alike: fewer fixations are the first of more."""
    alike: dict[str, list[ExperimentParameters]] = {}
    for fitted in settings:
        alike.setdefault(_look_key(fitted.parameters), []).append(fitted.parameters)
    most = {
        key: max(found, key=lambda one: one.attention.fixations) for key, found in alike.items()
    }
    return [replace(fitted, looking=most[_look_key(fitted.parameters)]) for fitted in settings]


def _look_key(parameters: ExperimentParameters) -> str:
    """Return the parameters of a look, without the number of fixations, as text."""
    attention = parameters.attention.model_copy(update={"fixations": 0})
    values = LOOK.written_values(parameters.model_copy(update={"attention": attention}))
    return json.dumps(values, sort_keys=True)


def _model_key(planned: Planned) -> tuple[str, str]:
    """Return what settings with one model have in common: features, and all parameters but the strategies."""
    parameters = planned.parameters
    probing = parameters.probing.model_copy(update={"strategies": ()})
    alike = parameters.model_copy(update={"probing": probing})
    return training_key(replace(planned, parameters=alike))


def fit_setting(
    setting: Setting, planned: Planned, features: pa.Table | str, seed: int
) -> RecognitionModel | None:
    """Train the model of a setting; return None where the training is refused."""
    try:
        rows = condition_features(planned, features, setting.strategy)
        recognition = planned.parameters.recognition
        return fit_model(rows, setting.pipeline, setting.classifier, recognition, seed)
    except REFUSALS:
        return None


def measure_seconds(
    surfaces: Mapping[str, Surface], settings: Sequence[FittedSetting], rounds: int
) -> pa.Table:
    """Time settings on the same objects: `tables.COST_SECONDS`, a row a recognition.

    The settings take turns, so other work on the machine affects all equally. Where a setting finds
    too few places to touch there is no row.
    """
    distinct = {one.setting.written_changes: one for one in settings}.values()
    rows: list[Row] = []
    with threadpool_limits(limits=1), ExitStack() as afterwards:
        afterwards.callback(cv2.setNumThreads, cv2.getNumThreads())
        cv2.setNumThreads(1)
        # What is made once for all, and once for a surface, is made here.
        for key, surface in surfaces.items():
            time_object(key, surface, list(distinct), 0)
        for turn, (key, surface) in product(range(rounds), surfaces.items()):
            rows += time_object(key, surface, settings, turn)
    return build_rows(COST_SECONDS, rows)


def time_object(
    key: str, surface: Surface, settings: Sequence[FittedSetting], turn: int
) -> list[Row]:
    """Time one recognition by each setting; what several have in common is done and timed once."""
    prepared = prepare(surface)
    felt: list[tuple[FittedSetting, pa.Table, Seconds]] = []
    for fitted in settings:
        choices = evenly_spaced_subsets(
            fitted.parameters.viewpoints.total, fitted.setting.viewpoints
        )
        # Another side of the object in each turn.
        subject = Subject(key, lambda: prepared.caster, choices[3 * turn % len(choices)].tolist())
        with suppress(*REFUSALS):
            felt.append((fitted, *feel(subject, prepared, fitted)))
    # An answer right after a phase takes a quarter longer, with none of its code in the processor's cache, and not
    # every setting has a phase to itself. So each answer that counts follows another answer.
    for fitted, features, _ in felt[:1]:
        answer_seconds(fitted, features)
    return [
        _row(fitted, seconds | {"seconds_classify": answered}, key, turn)
        for fitted, features, seconds in felt
        if (answered := answer_seconds(fitted, features)) is not None
    ]


def _row(fitted: FittedSetting, seconds: Seconds, key: str, turn: int) -> Row:
    verbs = (*(phase.verb for phase in OF_OBJECT), "classify")
    names = (fitted.setting.family, fitted.setting.name, key, turn)
    whole = sum(seconds[f"seconds_{verb}"] for verb in verbs)
    return {**dict(zip(COST_SECONDS.keys, names, strict=True)), "seconds": whole, **seconds}


def answer_seconds(fitted: FittedSetting, features: pa.Table) -> float | None:
    """Return the processor seconds of an answer; None where the model refuses the touches."""
    start = time.process_time()
    try:
        fitted.model.recognise(features)
    except REFUSALS:
        return None
    return time.process_time() - start


def feel(subject: Subject, prepared: Stage, fitted: FittedSetting) -> tuple[pa.Table, Seconds]:
    """Look at an object and touch it: `tables.FEATURES`, and the seconds of each part.

    The object's key is for the random generators, not for the prediction.
    """
    stage, features = prepared, list[pa.Table]()
    for block in subject.blocks(VIEWPOINTS_AT_ONCE):
        for phase in OF_OBJECT:
            asked = fitted.looking if phase is LOOK else fitted.parameters
            stage = stage.after(phase, block, asked)
        features.append(stage.tables["features"])
    return pa.concat_tables(features), dict(stage.seconds)


class TimedCaster(RayCaster):
    """A surface prepared for rays that adds up the processor seconds of casting them."""

    seconds = 0.0

    def first_hits(self, *rays: Any) -> Any:
        """Cast rays as `RayCaster` does."""
        start = time.process_time()
        found = super().first_hits(*rays)
        self.seconds += time.process_time() - start
        return found


@dataclass(frozen=True)
class Stage:
    """An object after a phase: its surface, the tables, and the seconds of all phases so far.

    `further` has what was asked for next, by some setting, and the stage to which that led.
    """

    caster: TimedCaster
    tables: Tables
    seconds: Seconds
    further: list[tuple[Any, Stage]] = field(default_factory=list)

    def after(self, phase: Phase, block: Subject, parameters: ExperimentParameters) -> Stage:
        """Go through a phase, once for all that ask for the same from the same viewpoints."""
        asked = block.viewpoints, phase.values(parameters)
        for known, stage in self.further:
            if known == asked:
                return stage
        # What is found out about the surface at first use, such as the faces at each corner, stays in the
        # copy, so that no other setting has it for nothing.
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
        found = Stage(caster, tables, seconds)
        self.further.append((asked, found))
        return found


def prepare(surface: Surface) -> Stage:
    """Prepare a surface for rays, which is a part of looking."""
    seconds = {name: 0.0 for name, _ in COST_PARTS}
    with _timed(seconds, "look"):
        caster = TimedCaster(surface)
        # The first ray finds the faces that lie on each other.
        caster.first_hits(np.zeros((1, 3)), np.ones((1, 3)))
    return Stage(caster, {}, seconds)


@contextmanager
def _timed(seconds: Seconds, name: str | None) -> Iterator[None]:
    start = time.process_time()
    yield
    taken = time.process_time() - start
    seconds[f"seconds_{name}"] = seconds.get(f"seconds_{name}", 0.0) + taken
