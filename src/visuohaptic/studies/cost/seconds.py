"""Run time of one recognition under each setting, without imports and files."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Hashable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import pyarrow as pa

from visuohaptic.fixations.sight import Sight
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import Surface, object_of, read_surface, usable_meshes
from visuohaptic.one_phase import Tables
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pipeline import OF_OBJECT, VIEWPOINTS_AT_ONCE, passed_on
from visuohaptic.recognition.model import RecognitionModel, fit_model
from visuohaptic.recognition.pooling import spread_choices
from visuohaptic.studies.conditions import Planned, plan_study
from visuohaptic.studies.cost.settings import COST_STUDY, FRONTIER, Setting, make_settings
from visuohaptic.studies.files import read_study_features
from visuohaptic.studies.measuring import REFUSALS, condition_features
from visuohaptic.studies.study import Given
from visuohaptic.tables.phases import FEATURES, of_objects
from visuohaptic.tables.schema import build_table, read_table, write_table
from visuohaptic.tables.studies import COST_SECONDS

PHASES = (*(str(phase.verb) for phase in OF_OBJECT), "name")
PARTS = ("render", "attend", "cast")
"""Parts of looking, the first two, and of touching."""

ROUNDS = {FRONTIER.name: 2}
"""Rounds of timing where they are not `cost.rounds`: the frontier is a part of every run."""


@dataclass(frozen=True)
class FittedSetting:
    """A setting with its parameters and a model that was trained for it."""

    setting: Setting
    parameters: ExperimentParameters
    model: RecognitionModel


class TimedCaster(RayCaster):
    """A surface prepared for rays that adds up the processor seconds of casting them."""

    seconds = 0.0

    def first_hits(self, *rays: Any) -> Any:
        """Cast rays as `RayCaster` does."""
        start = time.process_time()
        found = super().first_hits(*rays)
        self.seconds += time.process_time() - start
        return found


def make_cost_seconds(given: Given) -> None:
    """Time every setting of a study side by side: `tables.COST_SECONDS`."""
    surfaces = {
        object_of(mesh): read_surface(mesh) for mesh in usable_meshes(given.inputs["meshes"])
    }
    rounds = ROUNDS.get(given.study, given.run.cost.rounds)
    table = measure_seconds(surfaces, _fitted(given), rounds)
    write_table(COST_SECONDS, table, given.outputs[0])


def _fitted(given: Given) -> list[FittedSetting]:
    """Train a model for each setting, but for those that fail; one where settings name by the same model."""
    run, study = given.run, {one.name: one for one in (FRONTIER, COST_STUDY)}[given.study]
    own = read_table(FEATURES, given.inputs["features"])
    held: dict[str | None, pa.Table | str] = {None: of_objects(own, given.objects)}
    found: list[FittedSetting] = []
    trained: dict[Hashable, FittedSetting | str] = {}
    planned = plan_study(study, run).conditions
    for setting, one in zip(make_settings(run, study.name), planned, strict=True):
        if one.key is not None and one.key not in held:
            held[one.key] = read_study_features(given.made[one.key])
        named = (setting.strategy, setting.pipeline, setting.classifier)
        asked = (one.key, one.parameters.model_dump_json(), *named)
        if asked not in trained:
            trained[asked] = fit_setting(setting, one, held[one.key], run.seed)
        fitted = trained[asked]
        if isinstance(fitted, FittedSetting):
            found.append(replace(fitted, setting=setting))
    return found


def recognise_once(
    surface: Surface, key: str, viewpoints: Sequence[int], fitted: FittedSetting
) -> dict[str, float]:
    """Recognise one object once, from its surface in memory to its class.

    Gives the processor seconds of each of `PHASES` and `PARTS`; on one thread of an idle machine they equal the
    clock's. Preparing the surface for rays is a part of ``look``. The key is for the random
    generators, not for the prediction.
    """
    seconds: dict[str, float] = defaultdict(float)
    parts: list[pa.Table] = []
    with _timed(seconds, "look"):
        caster = TimedCaster(surface)
    subject = Subject(key, lambda: caster, viewpoints)
    for block in subject.blocks(VIEWPOINTS_AT_ONCE):
        tables: Tables = {}
        for phase in OF_OBJECT:
            before = caster.seconds
            with _timed(seconds, str(phase.verb)):
                found = phase.run(block, tables, fitted.parameters)
                if phase.verb == "look":
                    _look(found, seconds)
                tables |= passed_on(phase, found)
            if phase.verb == "touch":
                seconds["cast"] += caster.seconds - before
        parts.append(tables["features"])
    with _timed(seconds, "name"):
        fitted.model.recognise(pa.concat_tables(parts))
    return {name: seconds[name] for name in (*PHASES, *PARTS)}


def _look(sight: Sight, seconds: dict[str, float]) -> None:
    """Time the two parts of looking, where a strategy needs it."""
    if sight.needs_looks:
        for part, name in (("render", "seen"), ("attend", "looks")):
            with _timed(seconds, part):
                getattr(sight, name)


@contextmanager
def _timed(seconds: dict[str, float], name: str) -> Iterator[None]:
    start = time.process_time()
    yield
    seconds[name] += time.process_time() - start


def fit_setting(
    setting: Setting, planned: Planned, features: pa.Table | str, seed: int
) -> FittedSetting | str:
    """Train the model of a setting on every object, or give the error message."""
    if isinstance(features, str):
        return features
    parameters = planned.parameters
    try:
        rows = condition_features(planned, features, setting.strategy)
        model = fit_model(rows, setting.pipeline, setting.classifier, parameters.recognition, seed)
    except REFUSALS as refusal:
        return str(refusal)
    return FittedSetting(setting, parameters, model)


def measure_seconds(
    surfaces: Mapping[str, Surface],
    settings: Sequence[FittedSetting],
    rounds: int,
) -> pa.Table:
    """Time settings on the same objects: `tables.COST_SECONDS`, a row a recognition.

    The settings take turns, so other work on the machine affects all equally. Where a setting finds
    too few places to touch there is no row.
    """
    from threadpoolctl import threadpool_limits

    distinct = {one.setting.written_changes: one for one in settings}.values()
    rows: list[dict[str, object]] = []
    with threadpool_limits(limits=1), _one_thread():
        # What is made once for all, and once for a surface, is made here.
        for (key, surface), fitted in product(surfaces.items(), distinct):
            _time(fitted, key, surface, 0)
        for turn, (key, surface), fitted in product(range(rounds), surfaces.items(), settings):
            names = {"family": fitted.setting.family, "setting": fitted.setting.name}
            taken = _time(fitted, key, surface, turn)
            if taken is not None:
                rows.append({**names, "object": key, "turn": turn, **taken})
    columns = [column.name for column in COST_SECONDS.columns]
    return build_table(COST_SECONDS, {name: [row[name] for row in rows] for name in columns})


def _time(fitted: FittedSetting, key: str, surface: Surface, turn: int) -> dict[str, float] | None:
    """Time one recognition; None where there are too few places to touch."""
    choices = spread_choices(fitted.parameters.viewpoints.total, fitted.setting.viewpoints)
    # Another side of the object in each round.
    viewpoints = choices[3 * turn % len(choices)].tolist()
    try:
        taken = recognise_once(surface, key, viewpoints, fitted)
    except REFUSALS:
        return None
    parts = {f"seconds_{name}": value for name, value in taken.items()}
    return {"seconds": sum(taken[phase] for phase in PHASES), **parts}


@contextmanager
def _one_thread() -> Iterator[None]:
    """Keep OpenCV to one thread meanwhile."""
    import cv2

    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(threads)
