"""Run time of one recognition under each setting, without imports and files."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Hashable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import product
from typing import Any

import pyarrow as pa

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
from visuohaptic.studies.files import features_by_key
from visuohaptic.studies.measuring import REFUSALS, condition_features
from visuohaptic.studies.study import Given
from visuohaptic.tables.schema import build_rows, write_table
from visuohaptic.tables.studies import COST_SECONDS

Row = dict[str, object]
"""Of `tables.COST_SECONDS`."""

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
    """Train each setting that can be; one model where settings differ in the viewpoints alone."""
    run, study = given.run, {one.name: one for one in (FRONTIER, COST_STUDY)}[given.study]
    features = features_by_key(given.inputs["features"], given.made, given.objects)
    found: list[FittedSetting] = []
    trained: dict[Hashable, RecognitionModel | None] = {}
    planned = plan_study(study, run).conditions
    for setting, one in zip(make_settings(run, study.name), planned, strict=True):
        named = (setting.strategy, setting.pipeline, setting.classifier)
        asked = (one.key, one.parameters.model_dump_json(), *named)
        if asked not in trained:
            trained[asked] = fit_setting(setting, one, features(one.key), run.seed)
        if model := trained[asked]:
            found.append(FittedSetting(setting, one.parameters, model))
    return found


def fit_setting(
    setting: Setting, planned: Planned, features: pa.Table | str, seed: int
) -> RecognitionModel | None:
    """Train the model of a setting on every object; None where that is refused."""
    if isinstance(features, str):
        return None
    recognition = planned.parameters.recognition
    try:
        rows = condition_features(planned, features, setting.strategy)
        return fit_model(rows, setting.pipeline, setting.classifier, recognition, seed)
    except REFUSALS:
        return None


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
    for block in Subject(key, lambda: caster, viewpoints).blocks(VIEWPOINTS_AT_ONCE):
        tables: Tables = {}
        for phase in OF_OBJECT:
            before = caster.seconds
            with _timed(seconds, str(phase.verb)):
                found = phase.run(block, tables, fitted.parameters)
                if phase.verb == "look" and found.needs_looks:
                    for part, name in (("render", "seen"), ("attend", "looks")):
                        with _timed(seconds, part):
                            getattr(found, name)
                tables |= passed_on(phase, found)
            if phase.verb == "touch":
                seconds["cast"] += caster.seconds - before
        parts.append(tables["features"])
    with _timed(seconds, "name"):
        fitted.model.recognise(pa.concat_tables(parts))
    return {name: seconds[name] for name in (*PHASES, *PARTS)}


@contextmanager
def _timed(seconds: dict[str, float], name: str) -> Iterator[None]:
    start = time.process_time()
    yield
    seconds[name] += time.process_time() - start


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
    rows: list[Row] = []
    with threadpool_limits(limits=1), _one_thread():
        # What is made once for all, and once for a surface, is made here.
        for (key, surface), fitted in product(surfaces.items(), distinct):
            _time(fitted, key, surface, 0)
        for turn, (key, surface), fitted in product(range(rounds), surfaces.items(), settings):
            rows += _time(fitted, key, surface, turn)
    return build_rows(COST_SECONDS, rows)


def _time(fitted: FittedSetting, key: str, surface: Surface, turn: int) -> list[Row]:
    """Time one recognition; nothing where there are too few places to touch."""
    setting = fitted.setting
    choices = spread_choices(fitted.parameters.viewpoints.total, setting.viewpoints)
    # Another side of the object in each round.
    viewpoints = choices[3 * turn % len(choices)].tolist()
    try:
        taken = recognise_once(surface, key, viewpoints, fitted)
    except REFUSALS:
        return []
    parts = {f"seconds_{name}": value for name, value in taken.items()}
    own = {"family": setting.family, "setting": setting.name, "object": key, "turn": turn}
    return [{**own, "seconds": sum(taken[phase] for phase in PHASES), **parts}]


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
