"""Plan a study: the features that each condition recomputes, and the blocks of conditions that jobs measure.

The changed parameters of a condition determine the first phase to recompute. Conditions share a key, and a file of
recomputed features, if their parameters of these phases differ only in strategies and number of touches.
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
from visuohaptic.base.wrong_values import unknown_parameter
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.phases import OF_OBJECT
from visuohaptic.recognition.parameters import TOUCH_NETWORK, unread_by
from visuohaptic.studies.study import Changes, Condition, Study

AS_RUN = "as run"
"""Name of the condition without changes."""

HEADLINE_CLASSIFIERS: Mapping[str, str] = {
    "paper": "support_vector_machine",
    "order_free": "linear_discriminant",
    "learned": TOUCH_NETWORK,
}
"""The classifier of each pipeline whose accuracy is compared between conditions. Pipeline `paper`: the paper's most
accurate classifier. Pipeline `order_free`: chosen on separate objects (studies/classifier_settings). Pipeline `learned`
has one classifier."""

PAPER_AND_OURS = ("paper", "order_free")
"""The pipelines that a run compares by default."""

ONE_CLASSIFIER: Changes = {
    "recognition.classifiers": (HEADLINE_CLASSIFIERS["paper"],),
    "recognition.order_free.classifiers": (HEADLINE_CLASSIFIERS["order_free"],),
}
"""One classifier per pipeline."""

FIXATION_ONLY: Changes = {"probing.strategies": ("fixation",), **ONE_CLASSIFIER}
"""Touches by fixation and one classifier per pipeline."""

DESIRED_BLOCKS = 8
"""Number of blocks of a study, unless a block would exceed `MOST_CONDITIONS_PER_BLOCK`, or have too few trainings."""

MOST_CONDITIONS_PER_BLOCK = 25
"""Limit for the default size of a block, unless `LEAST_TRAININGS_PER_BLOCK` needs more conditions."""

LEAST_TRAININGS_PER_BLOCK = 4
"""Fewer trainings take less than three times the start of a job. Each pipeline and strategy of a condition is one
training."""

_ORDER = tuple(next(iter(phase.writes)) for phase in OF_OBJECT)
"""Name of each phase: the first table that it writes."""

_FIXED = {
    "plugins": "plug-ins are loaded once for the whole run",
    "workflow": "section workflow changes no result",
    "meshes": "a study uses the prepared objects of the run",
    "cost": "section cost belongs to the studies that measure time",
    "probing.random_draws": "a condition names draws, such as random#1, in probing.strategies",
    "recognition.intervals": "all conditions use the intervals of the run",
}
"""Sections and parameters that a condition can't change, with the reason for the error message."""

_MAY_VARY = ("meshes.turns", "meshes.turn_draw")
"""Exceptions from `_FIXED`: parameters that a condition may change."""


@dataclass(frozen=True)
class Recomputation:
    """Features that the run does not have, and that all conditions with one key share.

    Attributes
    ----------
    phase : str
        The first phase to recompute, named by its first table: ``views``, ``touches`` or ``features``.
    parameters : ExperimentParameters
        Parameters of the first of these conditions. Their `probing.strategies` are the strategies of all these
        conditions, and `attention.fixations` is the largest number of touches of the run and of these conditions.
    """

    phase: str
    parameters: ExperimentParameters


@dataclass(frozen=True)
class Planned:
    """A condition with its parameters and the key of its features.

    Attributes
    ----------
    condition : Condition
    parameters : ExperimentParameters
        The parameters of the run with the changes of the condition. `plan_study` sets `meshes.turns` and
        `meshes.turn_draw` to the turns that the run's meshes still need, ``none`` if they are turned already.
    key : str, optional
        The key of the recomputed features in `Plan.recomputations`; None if the condition uses the run's features.
    """

    condition: Condition
    parameters: ExperimentParameters
    key: str | None


@dataclass(frozen=True)
class Plan:
    """The conditions of a study in the study's order, and a `Recomputation` per key."""

    conditions: tuple[Planned, ...]
    recomputations: Mapping[str, Recomputation]


def with_changes(
    run: ExperimentParameters, changes: Changes, source: str = "changes"
) -> ExperimentParameters:
    """Return the parameters with some values changed.

    A new ``scene.preset`` replaces the whole scene before the other changes. `attention.fixations` is raised to
    `recognition.touches` if it is lower, unless `changes` has `attention.fixations`.

    Parameters
    ----------
    run : ExperimentParameters
        The parameters of the run.
    changes : mapping of str to Any
        New values by dotted name.
    source : str
        File or condition that error messages name first.

    Raises
    ------
    ParameterError
        If a name is unknown or can't vary, or a value is not allowed.
    """
    # Unchanged sections stay models, which are not validated again: there may be hundreds of conditions.
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
        values["attention"]["fixations"] = max(values["attention"]["fixations"], touches)
    return ExperimentParameters.from_mapping(values, source)


def plan_study(study: Study, run: ExperimentParameters, source: str | None = None) -> Plan:
    """Compute the parameters of each condition, and the features to recompute.

    A condition uses the run's features if all parameters of the phases before recognition are the run's. It may use
    fewer strategies and touches than the run. A new strategy, or more touches than the run's fixations, recomputes all
    phases from the views on. Conditions get one key if their other parameters of these phases are equal.

    Parameters
    ----------
    study : Study
    run : ExperimentParameters
        The parameters of the run.
    source : str, optional
        File that error messages name first, before the name of the condition; by default the study.

    Returns
    -------
    Plan
        All conditions, and one recomputation per key.

    Raises
    ------
    ParameterError
        If the changes of a condition are not allowed, or its turns differ from the run's although the run's objects
        are turned already.
    """
    source = source or f"study {study.name}"
    own = _upstream(_with_turns_to_apply(run, run, source))
    planned: list[Planned] = []
    needs: dict[str, list[Recomputation]] = {}
    for condition in study.conditions(run):
        parameters = with_changes(run, condition.changes, f"{source}: {condition.name}")
        parameters = _with_turns_to_apply(parameters, run, f"{source}: {condition.name}")
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
    merged = {key: _merge(needed, run) for key, needed in needs.items()}
    return Plan(tuple(planned), merged)


def is_measured_by_run(planned: Planned, run: ExperimentParameters) -> bool:
    """Return whether the run's predictions already contain the predictions of a condition.

    True only if `votes` is 1, not None, and if features and settings of recognition are the run's. The condition's
    `recognition.touches` must be the number `touches_of_run`, not None. Its strategies, pipelines and classifiers may
    be a part of the run's.
    """
    if planned.key is not None or planned.condition.votes != 1:
        return False
    own, needed = run.recognition, planned.parameters.recognition
    names_needed_and_run = [
        (needed.pipelines, own.pipelines),
        (planned.parameters.probing.strategies, run.probing.strategies),
    ]
    names_needed_and_run += [
        (needed.classifiers_of(pipeline), own.classifiers_of(pipeline))
        for pipeline in needed.pipelines
    ]
    if not all({*names} <= {*names_of_run} for names, names_of_run in names_needed_and_run):
        return False
    own_with_same_names = own.model_copy(
        update={
            "touches": touches_of_run(run),
            "pipelines": needed.pipelines,
            "classifiers": needed.classifiers,
            "order_free": own.order_free.model_copy(
                update={"classifiers": needed.order_free.classifiers}
            ),
        }
    )
    return needed == own_with_same_names


def make_blocks(plan: Plan, conditions_per_job: int | None) -> dict[str, list[Planned]]:
    """Divide the conditions into blocks; one job measures one block.

    Parameters
    ----------
    plan : Plan
        The plan of the study.
    conditions_per_job : int, optional
        The number of conditions per block. A block may have more, because conditions with one `training_key` stay in
        one block. The last block may have fewer. The default is the number of conditions divided by `DESIRED_BLOCKS`,
        at most `MOST_CONDITIONS_PER_BLOCK`. Conditions of few trainings get larger blocks: enough for
        `LEAST_TRAININGS_PER_BLOCK` on average.

    Returns
    -------
    dict of str to list of Planned
        The blocks; empty for a plan without conditions. The conditions are sorted by `training_key`. Name
        ``0000-0024`` is the block with indices 0 to 24 in this order, which is not the order of the plan.
    """
    least_size = conditions_per_job or _default_block_size(plan)
    blocks: list[list[Planned]] = []
    for _, same_training in groupby(sorted(plan.conditions, key=training_key), key=training_key):
        if not blocks or len(blocks[-1]) >= least_size:
            blocks.append([])
        blocks[-1] += same_training
    ends = [0, *accumulate(map(len, blocks))]
    return {
        f"{start:04d}-{end - 1:04d}": block
        for (start, end), block in zip(pairwise(ends), blocks, strict=True)
    }


def training_key(planned: Planned) -> tuple[str, str]:
    """Return the key of the features, ``""`` for the run's features, and all parameters as JSON.

    Conditions with equal training keys differ only in name, votes and comparison. Their classifiers are trained once.
    """
    return planned.key or "", planned.parameters.model_dump_json()


def _default_block_size(plan: Plan) -> int:
    """Return the default number of conditions per block, as `make_blocks` describes."""
    count = len(plan.conditions)
    trainings = sum(
        len(planned.parameters.recognition.pipelines) * len(planned.parameters.probing.strategies)
        for planned in plan.conditions
    )
    least = -(-LEAST_TRAININGS_PER_BLOCK * count // max(trainings, 1))
    return max(least, min(-(-count // DESIRED_BLOCKS), MOST_CONDITIONS_PER_BLOCK))


def describe_study(study: Study, plan: Plan) -> dict[str, Any]:
    """Return the name, title and conditions of a study in built-in types, for `figures.study_figures`.

    Each condition has ``name``, ``compared_with`` and ``recomputed``. ``compared_with`` None means the study's first
    condition. ``recomputed`` is the first recomputed phase, or ``recognition`` if the condition uses the run's features.
    """
    conditions = [
        {
            "name": planned.condition.name,
            "compared_with": planned.condition.compared_with,
            "recomputed": plan.recomputations[planned.key].phase if planned.key else "recognition",
        }
        for planned in plan.conditions
    ]
    return {"name": study.name, "title": study.title, "conditions": conditions}


def describe_conditions(conditions: Sequence[Planned]) -> list[dict[str, Any]]:
    """Return ``name``, ``votes``, ``key`` and ``parameters`` per condition, for `measuring.make_study_block`.

    The measurement reads only ``parameters``, so that a change of another parameter does not repeat the measurement.
    """
    return [
        {
            "name": planned.condition.name,
            "votes": planned.condition.votes,
            "key": planned.key,
            "parameters": _read_in_measuring(planned.parameters),
        }
        for planned in conditions
    ]


def _read_in_measuring(parameters: ExperimentParameters) -> dict[str, Any]:
    """Return the parameters that training and testing read, in built-in types; defaults are left out."""
    unread = {"intervals", *unread_by(*parameters.recognition.pipelines)}
    return {
        **parameters.model_dump(include={"attention": {"fixations"}, "probing": {"strategies"}}),
        "recognition": parameters.recognition.model_dump(exclude=unread, exclude_defaults=True),
    }


def touches_needed(parameters: ExperimentParameters) -> int:
    """Return the number of touches per sequence to compute: the fixations, or the touches to classify if more."""
    return max(parameters.attention.fixations, parameters.recognition.touches or 0)


def touches_of_run(run: ExperimentParameters) -> int:
    """Return the number of touches per sequence that the run classifies: `recognition.touches`, or all fixations."""
    return run.recognition.touches or run.attention.fixations


def _set(values: dict[str, Any], path: str, new: object, source: str) -> None:
    """Set the value at a dotted name in place; raise `ParameterError` if it is unknown or can't vary."""
    for fixed, reason in _FIXED.items():
        if path not in _MAY_VARY and (path == fixed or path.startswith(f"{fixed}.")):
            raise ParameterError(f"{source}: {path} can't vary, because {reason}.")
    section: Any = values
    parts = path.split(".")
    for depth, part in enumerate(parts):
        if not isinstance(section, dict) or part not in section:
            above = ".".join(parts[:depth]) or "an experiment"
            allowed = ", ".join(section) if isinstance(section, dict) else "no parts"
            raise ParameterError(f"{source}: {unknown_parameter(path)}; {above} has {allowed}.")
        parent, section = section, section[part]
    parent[part] = new


def _with_turns_to_apply(
    parameters: ExperimentParameters, run: ExperimentParameters, source: str
) -> ExperimentParameters:
    """Set `meshes.turns` to ``none`` if the run's meshes have these turns; refuse other turns of turned meshes."""
    meshes, own = parameters.meshes, run.meshes
    if meshes.turns == "none" == own.turns:
        further = meshes.model_copy(update={"turn_draw": 0})
    elif (meshes.turns, meshes.turn_draw) == (own.turns, own.turn_draw):
        further = meshes.model_copy(update={"turns": "none", "turn_draw": 0})
    elif own.turns == "none":
        further = meshes
    else:
        raise ParameterError(
            f"{source}: meshes.turns is {meshes.turns}, but the run's objects are turned already "
            f"({own.turns}); a study with other turns needs meshes.turns: none in params.yaml."
        )
    return parameters.model_copy(update={"meshes": further})


def _upstream(parameters: ExperimentParameters) -> dict[str, Any]:
    """Return the parameter values of each phase, by the names in `_ORDER`, without strategies and fixations."""
    attention = parameters.attention.model_copy(update={"fixations": 0})
    probing = parameters.probing.model_copy(update={"strategies": ()})
    shared = parameters.model_copy(update={"attention": attention, "probing": probing})
    values = [phase.written_values(shared) for phase in OF_OBJECT]
    if parameters.meshes.turns != "none":
        values[0]["turns"] = parameters.meshes.turns, parameters.meshes.turn_draw
    return dict(zip(_ORDER, values, strict=True))


def _merge(recomputations: Sequence[Recomputation], run: ExperimentParameters) -> Recomputation:
    """Merge the recomputations of one key: the earliest phase, the most touches, and all strategies."""
    parameters = [recomputation.parameters for recomputation in recomputations]
    first = parameters[0]
    # At least the touches of the run, so that other `recognition.touches` recompute nothing.
    fixations = max(run.attention.fixations, *map(touches_needed, parameters))
    strategies = dict.fromkeys(name for each in parameters for name in each.probing.strategies)
    update = {
        "attention": first.attention.model_copy(update={"fixations": fixations}),
        "probing": first.probing.model_copy(update={"strategies": tuple(strategies)}),
    }
    phase = min((recomputation.phase for recomputation in recomputations), key=_ORDER.index)
    return Recomputation(phase, first.model_copy(update=update))
