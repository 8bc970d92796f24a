"""Run time of one recognition under each setting, without imports and files."""

from __future__ import annotations

import json
import time
from collections import defaultdict
from collections.abc import Collection, Hashable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
import pyarrow as pa

from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import Surface, object_of, read_surface, usable_meshes
from visuohaptic.one_phase import Tables
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pipeline import OF_OBJECT, VIEWPOINTS_AT_ONCE, Phase, passed_on
from visuohaptic.recognition.model import RecognitionModel, fit_model
from visuohaptic.recognition.pooling import spread_choices
from visuohaptic.studies.conditions import Planned, plan_study
from visuohaptic.studies.cost.settings import COST_STUDY, FRONTIER, Setting, make_settings
from visuohaptic.studies.measuring import REFUSALS, condition_features, features_by_key
from visuohaptic.studies.study import Given
from visuohaptic.tables.schema import build_rows, write_table
from visuohaptic.tables.studies import COST_SECONDS

Row = dict[str, object]
"""Of `tables.COST_SECONDS`."""

PHASES = (*(str(phase.verb) for phase in OF_OBJECT), "classify")
PARTS = ("render", "attend", "cast")
"""Parts of looking, the first two, and of touching."""

FRONTIER_ROUNDS = 2
"""Instead of `cost.rounds`, as the frontier is a part of every run."""


@dataclass(frozen=True)
class FittedSetting:
    """A setting with its parameters and a model that was trained for it."""

    setting: Setting
    parameters: ExperimentParameters
    model: RecognitionModel

    @cached_property
    def written(self) -> tuple[str, ...]:
        """What each phase of an object is asked for, as JSON."""
        values = (phase.written_values(self.parameters) for phase in OF_OBJECT)
        return tuple(json.dumps(one, sort_keys=True) for one in values)


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
    fitted = _fitted(given)
    meshes = usable_meshes(given.inputs["meshes"]) if fitted else ()
    surfaces = {object_of(mesh): read_surface(mesh) for mesh in meshes}
    rounds = FRONTIER_ROUNDS if given.study == FRONTIER.name else given.run.cost.rounds
    write_table(COST_SECONDS, measure_seconds(surfaces, fitted, rounds), given.outputs[0])


def _fitted(given: Given) -> list[FittedSetting]:
    """Train each setting that can be; one model where settings differ in the viewpoints alone."""
    run, study = given.run, FRONTIER if given.study == FRONTIER.name else COST_STUDY
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
    """Train a model that answers as quickly as a setting's own; None where that is refused."""
    # The time of an answer follows from sizes: of the descriptors, the projection and the classifier,
    # and of the training that new objects are compared with. Neither the number of folds that
    # calibrate the answer nor classifiers of shorter sequences change one.
    recognition = planned.parameters.recognition
    best = recognition.best.model_copy(update={"calibration_folds": 2, "short_touches": ()})
    quick = recognition.model_copy(update={"best": best})
    try:
        rows = condition_features(planned, features, setting.strategy)
        return fit_model(rows, setting.pipeline, setting.classifier, quick, seed)
    except REFUSALS:
        return None


@dataclass(frozen=True)
class Done:
    """An object after a phase: its surface, the tables, and the seconds of all phases so far."""

    caster: TimedCaster
    tables: Tables
    seconds: Mapping[str, float]


class ObjectRound:
    """One object in one round, where what several settings have in common is done and timed once.

    That is preparing the surface, and each phase from the same viewpoints by the same parameters, of
    this phase and of those before it.
    """

    def __init__(self, key: str, surface: Surface) -> None:
        self.key = key
        self._known: dict[Hashable, Done] = {}
        seconds: dict[str, float] = defaultdict(float)
        with _timed(seconds, "look"):
            caster = TimedCaster(surface)
            # The first ray finds the faces that lie on each other.
            caster.first_hits(np.zeros((1, 3)), np.ones((1, 3)))
        self._prepared = Done(caster, {}, seconds)

    def recognise(self, viewpoints: Sequence[int], fitted: FittedSetting) -> dict[str, float]:
        """Recognise the object once: the processor seconds of each of `PHASES` and `PARTS`.

        Preparing the surface for rays is a part of ``look``. The object's key is for the random
        generators, not for the prediction.
        """
        done, asked, parts = self._prepared, tuple[Hashable, ...](), list[pa.Table]()
        subject = Subject(self.key, lambda: self._prepared.caster, viewpoints)
        for block in subject.blocks(VIEWPOINTS_AT_ONCE):
            for phase, written in zip(OF_OBJECT, fitted.written, strict=True):
                asked = (*asked, tuple(block.viewpoints), written)
                if asked not in self._known:
                    self._known[asked] = _do(phase, block, done, fitted.parameters)
                done = self._known[asked]
            parts.append(done.tables["features"])
        seconds = defaultdict(float, done.seconds)
        with _timed(seconds, "classify"):
            fitted.model.recognise(pa.concat_tables(parts))
        return {name: seconds[name] for name in (*PHASES, *PARTS)}


def _do(phase: Phase, block: Subject, before: Done, parameters: ExperimentParameters) -> Done:
    """Go through one phase."""
    # What is found out about the surface at first use, such as the faces at each corner, stays in the
    # copy, so that no other setting has it for nothing.
    caster, seconds = copy(before.caster), defaultdict(float, before.seconds)
    subject = Subject(block.key, lambda: caster, block.viewpoints)
    verb = str(phase.verb)
    with _timed(seconds, verb):
        found = phase.run(subject, before.tables, parameters)
        if verb == "look" and found.needs_looks:
            for part, name in (("render", "seen"), ("attend", "looks")):
                with _timed(seconds, part):
                    getattr(found, name)
        tables = before.tables | passed_on(phase, found)
    if verb == "touch":
        seconds["cast"] += caster.seconds - before.caster.seconds
    return Done(caster, tables, seconds)


@contextmanager
def _timed(seconds: dict[str, float], name: str) -> Iterator[None]:
    start = time.process_time()
    yield
    seconds[name] += time.process_time() - start


def measure_seconds(
    surfaces: Mapping[str, Surface], settings: Sequence[FittedSetting], rounds: int
) -> pa.Table:
    """Time settings on the same objects: `tables.COST_SECONDS`, a row a recognition.

    The settings take turns, so other work on the machine affects all equally. Where a setting finds
    too few places to touch there is no row.
    """
    import cv2
    from threadpoolctl import threadpool_limits

    distinct = {one.setting.written_changes: one for one in settings}.values()
    rows: list[Row] = []
    with threadpool_limits(limits=1), ExitStack() as afterwards:
        afterwards.callback(cv2.setNumThreads, cv2.getNumThreads())
        cv2.setNumThreads(1)
        # What is made once for all, and once for a surface, is made here.
        for key, surface in surfaces.items():
            _time_all(distinct, ObjectRound(key, surface), 0)
        for turn, (key, surface) in product(range(rounds), surfaces.items()):
            rows += _time_all(settings, ObjectRound(key, surface), turn)
    return build_rows(COST_SECONDS, rows)


def _time_all(settings: Collection[FittedSetting], once: ObjectRound, turn: int) -> list[Row]:
    """Time one recognition by each setting in turn."""
    # All phases are gone through before any answer counts. An answer right after a phase takes a quarter
    # longer, with none of its code in the processor's cache, and not every setting has a phase to itself.
    for _ in range(2):
        rows = [row for fitted in settings for row in _time(fitted, once, turn)]
    return rows


def _time(fitted: FittedSetting, once: ObjectRound, turn: int) -> list[Row]:
    """Time one recognition; nothing where there are too few places to touch."""
    setting = fitted.setting
    choices = spread_choices(fitted.parameters.viewpoints.total, setting.viewpoints)
    # Another side of the object in each round.
    viewpoints = choices[3 * turn % len(choices)].tolist()
    try:
        taken = once.recognise(viewpoints, fitted)
    except REFUSALS:
        return []
    parts = {f"seconds_{name}": value for name, value in taken.items()}
    own = {"family": setting.family, "setting": setting.name, "object": once.key, "turn": turn}
    return [{**own, "seconds": sum(taken[phase] for phase in PHASES), **parts}]
