"""Look at objects in every sight and touch them by every strategy, one object after the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa
from joblib import Parallel, delayed
from numpy.typing import NDArray

from eye_and_touch.seeing import SIGHTS, describe_views
from eye_and_touch.study import CUES
from touch_curves.study import LONGEST_SEQUENCE
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.evaluation.summary import select
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import object_of, usable_meshes
from visuohaptic.parameters import CostParameters, ExperimentParameters
from visuohaptic.phases import phase
from visuohaptic.pipeline import VIEWPOINTS_AT_ONCE, run_phase, tables_for_next
from visuohaptic.pipeline import run as run_phases
from visuohaptic.recognition.sequences import (
    TouchSequences,
    classes_of_two,
    gather_pipeline,
    viewpoints_of_all,
    whole_sequences,
)
from visuohaptic.studies.conditions import touches_of_run, with_changes
from visuohaptic.studies.learning_policies import gather_candidates

if TYPE_CHECKING:
    from visuohaptic.studies.learning_policies import Candidates

ADAPTIVE = "adaptive"
BLIND = "random"
"""The strategy that needs no look."""

STRATEGIES = ("fixation", BLIND, "random_visible")
"""Strategies that list their places to touch beforehand; by the first, senses are compared in every sight."""


@dataclass(frozen=True)
class Sensed:
    """What is known of s viewpoints of all objects: by cue (s, sights, d), and by strategy features of t touches, (s, t, k).

    `sequences` have the objects, classes and names of features; `candidates` are where `ADAPTIVE` may
    touch, if it is compared.
    """

    sequences: TouchSequences
    seen: dict[str, NDArray[np.float32]]
    touched: dict[str, NDArray[np.float64]]
    candidates: Candidates | None


def compared(cost: CostParameters) -> tuple[str, ...]:
    """Name the strategies that are compared."""
    return (*STRATEGIES, ADAPTIVE) if cost.adaptive else STRATEGIES


def most_touches(run: ExperimentParameters) -> int:
    """Give the touches that the largest budget allows, at most `LONGEST_SEQUENCE`, at least the run's."""
    affordable = int(max(run.cost.budgets) // run.cost.touch_seconds)
    return max(min(affordable, LONGEST_SEQUENCE), touches_of_run(run))


def sense_object(
    mesh: str | Path, run: ExperimentParameters
) -> tuple[pa.Table, dict[str, NDArray[np.float32]]]:
    """Touch an object by every strategy but `ADAPTIVE`, and describe its views.

    Gives rows of `tables.FEATURES`, and by cue descriptors of all viewpoints, shape (v, sights, d).
    """
    changes = {
        "probing.strategies": STRATEGIES,
        "probing.when_exhausted": "begin_again",
        "recognition.touches": most_touches(run),
    }
    parameters, looking = with_changes(run, changes), phase("fixations")
    key = object_of(mesh)
    whole = Subject.of_mesh(key, mesh, range(parameters.viewpoints.count))
    features: list[pa.Table] = []
    seen: list[dict[str, NDArray[np.float32]]] = []
    for part in whole.blocks(VIEWPOINTS_AT_ONCE):
        look = run_phase(looking, part, {}, parameters)
        generators = {
            sight: [spawn_generator(run.seed, "sight", sight, key, one) for one in part.viewpoints]
            for sight in SIGHTS
        }
        seen.append(describe_views(look.seen, generators))
        features.append(run_phases(part, parameters, tables_for_next(looking, look))["features"])
    views = {cue: np.concatenate([one[cue] for one in seen]) for cue in CUES}
    return pa.concat_tables(features), views


def sense_all(
    meshes: Sequence[str | Path],
    candidates: pa.Table | None,
    run: ExperimentParameters,
    processes: int,
) -> Sensed:
    """Look at and touch all objects.

    Viewpoints from which a strategy has no place to touch are left out for all, and classes with a
    single object. `candidates` are as `make_candidates` writes them.
    """
    usable, touches = usable_meshes(meshes), most_touches(run)
    sensed = Parallel(processes)(delayed(sense_object)(mesh, run) for mesh in usable)
    views = {object_of(mesh): one[1] for mesh, one in zip(usable, sensed, strict=True)}
    rows = pa.concat_tables([one[0] for one in sensed])
    whole = classes_of_two(viewpoints_of_all(whole_sequences(rows, touches)[0]))
    if candidates is not None:
        whole, candidates = _both(whole, candidates), _both(candidates, whole)
    recognition = run.recognition.model_copy(update={"touches": touches})
    gathered = {
        strategy: gather_pipeline(
            select(whole, strategy=strategy), recognition, "order_free", run.seed
        )
        for strategy in STRATEGIES
    }
    sequences = gathered[STRATEGIES[0]]
    keys = ["/".join(sequences.objects[place]) for place in sequences.object_index]
    places = list(zip(keys, sequences.viewpoint, strict=True))
    seen = {cue: np.stack([views[key][cue][view] for key, view in places]) for cue in CUES}
    touched = {strategy: one.features for strategy, one in gathered.items()}
    names = sequences.feature_names
    chosen = None if candidates is None else gather_candidates(candidates, names)
    return Sensed(sequences, seen, touched, chosen)


def _both(table: pa.Table, other: pa.Table) -> pa.Table:
    """Take the rows of a table whose viewpoint is in another table, too."""
    keys = ["class", "object", "viewpoint"]
    there = other.group_by(keys).aggregate([])
    return table.join(there, keys, join_type="left semi").select(table.column_names)
