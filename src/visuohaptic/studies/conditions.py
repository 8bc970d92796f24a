"""The plan of a study: what its conditions recompute, what they share, and the blocks that measure them.

What a condition recomputes follows from the sections that it changes. What several conditions
need alike has one key and is made once.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate, groupby, pairwise
from typing import Any

from pydantic import BaseModel

from visuohaptic.base.errors import ParameterError
from visuohaptic.io.moved import unknown_parameter
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.phases import OF_OBJECT
from visuohaptic.studies.study import Changes, Condition, Study

AS_RUN = "as run"
"""The condition that changes nothing."""

HEADLINE_CLASSIFIERS: Mapping[str, str] = {
    "paper": "support_vector_machine",
    "order_free": "linear_discriminant",
}
"""The classifier by which conditions are compared, by pipeline: the best of the paper, and the one that was chosen on
objects that report nothing (studies/classifier_settings)."""

ONE_CLASSIFIER: Changes = {
    "recognition.classifiers": (HEADLINE_CLASSIFIERS["paper"],),
    "recognition.order_free.classifiers": (HEADLINE_CLASSIFIERS["order_free"],),
}
"""One classifier per pipeline."""

FIXATION_ONLY: Changes = {"probing.strategies": ("fixation",), **ONE_CLASSIFIER}
"""Touches by fixation and one classifier per pipeline."""

MOST_BLOCKS = 8
MOST_CONDITIONS_A_BLOCK = 25
LEAST_TRAININGS_A_BLOCK = 12
"""Fewer pairs of a pipeline and a strategy take no longer than a job needs to start."""

_ORDER = tuple(next(iter(phase.writes)) for phase in OF_OBJECT)
"""The first table of each phase: from which on something is recomputed."""

_FIXED = {
    "plugins": "they are code of the whole run",
    "workflow": "it changes no result",
    "meshes": "a study has the prepared objects of the run",
    "cost": "it belongs to what is timed",
    "probing.random_draws": "a condition names its draws, such as random#1, among probing.strategies",
    "recognition.intervals": "all conditions have the intervals of the run",
}

_MAY_VARY = ("meshes.turns", "meshes.turn_draw")
"""Parameters of fixed sections that a condition may change."""


@dataclass(frozen=True)
class Recomputation:
    """Features that a run does not have: those from `phase` on, the first that is recomputed.

    `parameters` ask for the strategies and the touches of all conditions that share them.
    """

    phase: str
    parameters: ExperimentParameters


@dataclass(frozen=True)
class Planned:
    """A condition, its parameters, and the key of its features; None for those of the run."""

    condition: Condition
    parameters: ExperimentParameters
    key: str | None


@dataclass(frozen=True)
class Plan:
    """The conditions of a study in their order, and the features that they need, by key."""

    conditions: tuple[Planned, ...]
    recomputations: Mapping[str, Recomputation]


def with_changes(
    run: ExperimentParameters, changes: Changes, source: str = "params.yaml"
) -> ExperimentParameters:
    """Change parameters by their dotted names; raises `ParameterError`, which begins with `source`.

    A new ``scene.preset`` replaces the whole scene; more `recognition.touches` than there are
    fixations bring as many fixations.
    """
    # Sections that no change concerns are not checked again; there may be hundreds of conditions.
    values: dict[str, Any] = {name: getattr(run, name) for name in type(run).model_fields}
    for name in {path.partition(".")[0] for path in changes} | {"recognition", "attention"}:
        if isinstance(values.get(name), BaseModel):
            values[name] = values[name].model_dump()
    if "scene.preset" in changes:
        preset = {"scene": {"preset": changes["scene.preset"]}}
        values["scene"] = ExperimentParameters.from_mapping(preset, source).scene.model_dump()
    for path, value in changes.items():
        _set(values, path, value, source)
    touches = values["recognition"]["touches"]
    if isinstance(touches, int) and "attention.fixations" not in changes:
        # More touches than the run has are made for the condition.
        values["attention"]["fixations"] = max(values["attention"]["fixations"], touches)
    return ExperimentParameters.from_mapping(values, source)


def plan_study(study: Study, run: ExperimentParameters, source: str = "params.yaml") -> Plan:
    """Find out what a study's conditions recompute, and what they share.

    Conditions that need the same features have the same key. Raises `ParameterError`, which names
    the condition, if one can't be made.
    """
    own = _upstream(_turned_further(run, run, source))
    planned: list[Planned] = []
    needs: dict[str, list[Recomputation]] = {}
    for condition in study.conditions(run):
        parameters = with_changes(run, condition.changes, f"{source}: {condition.name}")
        parameters = _turned_further(parameters, run, f"{source}: {condition.name}")
        upstream = _upstream(parameters)
        phase = next((name for name in _ORDER if upstream[name] != own[name]), None)
        strategies = set(parameters.probing.strategies) - set(run.probing.strategies)
        if strategies or touches_needed(parameters) > run.attention.fixations:
            phase = _ORDER[0]
        key = None
        if phase is not None:
            text = json.dumps(upstream, sort_keys=True)
            key = hashlib.sha256(text.encode()).hexdigest()[:12]
            needs.setdefault(key, []).append(Recomputation(phase, parameters))
        planned.append(Planned(condition, parameters, key))
    return Plan(tuple(planned), {key: _merge(found) for key, found in needs.items()})


def is_measured_by_run(planned: Planned, run: ExperimentParameters) -> bool:
    """Return whether the run's own predictions, one viewpoint a recognition, are those of a condition.

    So they are where the condition asks for the run's touches and recognition, and for no other strategy, pipeline or
    classifier than the run has.
    """
    if planned.key is not None or planned.condition.votes != 1:
        return False
    own, asked = run.recognition, planned.parameters.recognition
    chosen = [
        (asked.pipelines, own.pipelines),
        (planned.parameters.probing.strategies, run.probing.strategies),
    ]
    if "paper" in asked.pipelines:
        chosen.append((asked.classifiers, own.classifiers))
    if "order_free" in asked.pipelines:
        chosen.append((asked.order_free.classifiers, own.order_free.classifiers))
    if not all({*few} <= {*all_of_run} for few, all_of_run in chosen):
        return False
    alike = own.model_copy(
        update={
            "touches": touches_of_run(run),
            "pipelines": asked.pipelines,
            "classifiers": asked.classifiers,
            "order_free": own.order_free.model_copy(
                update={"classifiers": asked.order_free.classifiers}
            ),
        }
    )
    return asked == alike


def make_blocks(plan: Plan, conditions_per_job: int | None) -> dict[str, list[Planned]]:
    """Cut a study into blocks that a job each measures, by names such as ``0000-0024``.

    A block has `conditions_per_job` conditions, or some more, so that conditions that differ in the
    number of votes share one training. Without `conditions_per_job` a block has an eighth of the conditions, at most
    25, and at least as many as are worth a job.
    """
    step = conditions_per_job or _conditions_a_block(plan)
    blocks: list[list[Planned]] = []
    for _, alike in groupby(sorted(plan.conditions, key=training_key), key=training_key):
        if not blocks or len(blocks[-1]) >= step:
            blocks.append([])
        blocks[-1] += alike
    ends = [0, *accumulate(map(len, blocks))]
    return {
        f"{start:04d}-{end - 1:04d}": block
        for (start, end), block in zip(pairwise(ends), blocks, strict=True)
    }


def training_key(planned: Planned) -> tuple[str, str]:
    """Return the features and parameters of a condition: conditions with the same key share one training."""
    return planned.key or "", planned.parameters.model_dump_json()


def _conditions_a_block(plan: Plan) -> int:
    count = len(plan.conditions)
    trainings = sum(
        len(one.parameters.recognition.pipelines) * len(one.parameters.probing.strategies)
        for one in plan.conditions
    )
    least = -(-LEAST_TRAININGS_A_BLOCK * count // max(trainings, 1))
    return max(least, min(-(-count // MOST_BLOCKS), MOST_CONDITIONS_A_BLOCK))


def describe_study(study: Study, plan: Plan) -> dict[str, Any]:
    """Describe a study and its conditions in built-in types."""
    conditions = [
        {
            "name": one.condition.name,
            "compared_with": one.condition.compared_with,
            "recomputed": plan.recomputations[one.key].phase if one.key else "recognition",
        }
        for one in plan.conditions
    ]
    return {"name": study.name, "title": study.title, "conditions": conditions}


def describe_conditions(planned: Sequence[Planned]) -> list[dict[str, Any]]:
    """Describe conditions, as their measurement needs them, in built-in types."""
    return [
        {
            "name": one.condition.name,
            "changes": dict(one.condition.changes),
            "votes": one.condition.votes,
            "key": one.key,
        }
        for one in planned
    ]


def touches_needed(parameters: ExperimentParameters) -> int:
    """Return the number of touches that a sequence must have: recognition may ask for more than are made."""
    return max(parameters.attention.fixations, parameters.recognition.touches or 0)


def touches_of_run(run: ExperimentParameters) -> int:
    """Return the number of touches per sequence that the run classifies."""
    return run.recognition.touches or run.attention.fixations


def _set(values: dict[str, Any], path: str, new: object, source: str) -> None:
    for fixed, reason in _FIXED.items():
        if path not in _MAY_VARY and (path == fixed or path.startswith(f"{fixed}.")):
            raise ParameterError(f"{source}: {path} can't vary, for {reason}.")
    section: Any = values
    parts = path.split(".")
    for place, part in enumerate(parts):
        if not isinstance(section, dict) or part not in section:
            above = ".".join(parts[:place]) or "an experiment"
            allowed = ", ".join(section) if isinstance(section, dict) else "no parts"
            raise ParameterError(f"{source}: {unknown_parameter(path)}; {above} has {allowed}.")
        whole, section = section, section[part]
    whole[part] = new


def _turned_further(
    parameters: ExperimentParameters, run: ExperimentParameters, source: str
) -> ExperimentParameters:
    """Replace how objects are turned by how they are turned beyond the run's meshes."""
    asked, own = parameters.meshes, run.meshes
    if asked.turns == "none" == own.turns:
        further = asked.model_copy(update={"turn_draw": 0})
    elif (asked.turns, asked.turn_draw) == (own.turns, own.turn_draw):
        further = asked.model_copy(update={"turns": "none", "turn_draw": 0})
    elif own.turns == "none":
        further = asked
    else:
        raise ParameterError(
            f"{source}: meshes.turns is {asked.turns}, and the run's objects are turned already "
            f"({own.turns}); meshes.turns: none is needed in params.yaml for other turns in a study."
        )
    return parameters.model_copy(update={"meshes": further})


def _upstream(parameters: ExperimentParameters) -> dict[str, Any]:
    """Return the parameters that each phase's tables depend on, without the number of touches."""
    attention = parameters.attention.model_copy(update={"fixations": 0})
    probing = parameters.probing.model_copy(update={"strategies": ()})
    alike = parameters.model_copy(update={"attention": attention, "probing": probing})
    found = [phase.written_values(alike) for phase in OF_OBJECT]
    if parameters.meshes.turns != "none":
        found[0]["turns"] = parameters.meshes.turns, parameters.meshes.turn_draw
    return dict(zip(_ORDER, found, strict=True))


def _merge(found: Sequence[Recomputation]) -> Recomputation:
    """Return one recomputation for all: from the first phase, with the most touches and every strategy."""
    first, wanted = found[0].parameters, [one.parameters for one in found]
    fixations = max(map(touches_needed, wanted))
    strategies = dict.fromkeys(name for one in wanted for name in one.probing.strategies)
    update = {
        "attention": first.attention.model_copy(update={"fixations": fixations}),
        "probing": first.probing.model_copy(update={"strategies": tuple(strategies)}),
    }
    phase = min((one.phase for one in found), key=_ORDER.index)
    return Recomputation(phase, first.model_copy(update=update))
