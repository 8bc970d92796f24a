"""Look at objects in every sight, and touch them by every strategy, one object at a time."""

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
from touch_curves.learning import gather_candidates
from touch_curves.study import LONGEST_SEQUENCE
from visuohaptic.base.seeds import spawn_generator
from visuohaptic.evaluation.summary import select
from visuohaptic.geometry.subject import Subject
from visuohaptic.geometry.surface import object_of, usable_meshes
from visuohaptic.parameters import CostParameters, ExperimentParameters
from visuohaptic.phases import phase
from visuohaptic.pipeline import blocks_of, run_phase, tables_for_next
from visuohaptic.pipeline import run as run_phases
from visuohaptic.recognition.sequences import (
    TouchSequences,
    classes_of_two,
    gather_pipeline,
    viewpoints_of_all,
    whole_sequences,
)
from visuohaptic.studies.conditions import touches_of_run, with_changes

if TYPE_CHECKING:
    from touch_curves.learning import Candidates

ADAPTIVE = "adaptive"
BLIND = "random"
"""Strategy that needs no look."""

STRATEGIES = ("fixation", BLIND, "random_visible")
"""Strategies that choose all locations before the first touch. By the first, senses are compared in every sight."""


@dataclass(frozen=True)
class Sensed:
    """Descriptors of views, and features of touches, from s viewpoints of all objects.

    Attributes
    ----------
    sequences : TouchSequences
        Touches by the first strategy, with objects, classes and names of features.
    seen : dict of str to ndarray of shape (s, sights, d), float32
        Descriptors of the views by cue.
    touched : dict of str to ndarray of shape (s, t, k)
        Features of t touches by strategy.
    candidates : Candidates or None
        Touches among which `ADAPTIVE` chooses; None if it is not compared.
    """

    sequences: TouchSequences
    seen: dict[str, NDArray[np.float32]]
    touched: dict[str, NDArray[np.float64]]
    candidates: Candidates | None


def compared(cost: CostParameters) -> tuple[str, ...]:
    """Return the names of the strategies that are compared."""
    return (*STRATEGIES, ADAPTIVE) if cost.adaptive else STRATEGIES


def most_touches(run: ExperimentParameters) -> int:
    """Return how many touches the largest budget allows: at most `LONGEST_SEQUENCE`, at least the touches of the run."""
    affordable = int(max(run.cost.budgets) // run.cost.touch_seconds)
    return max(min(affordable, LONGEST_SEQUENCE), touches_of_run(run))


def sense_object(
    mesh: str | Path, run: ExperimentParameters
) -> tuple[pa.Table, dict[str, NDArray[np.float32]]]:
    """Touch an object by every strategy of `STRATEGIES`, and describe its views.

    Returns rows of `tables.FEATURES`, and descriptors of all viewpoints by cue, shape (v, sights, d).
    """
    changes = {
        "probing.strategies": STRATEGIES,
        "probing.when_exhausted": "begin_again",
        "recognition.touches": most_touches(run),
    }
    parameters, looking = with_changes(run, changes), phase("fixations")
    key = object_of(mesh)
    subject = Subject.of_mesh(key, mesh, range(parameters.viewpoints.count))
    features: list[pa.Table] = []
    seen: list[dict[str, NDArray[np.float32]]] = []
    for block in blocks_of(subject, parameters):
        look = run_phase(looking, block, {}, parameters)
        generators = {
            sight: [
                spawn_generator(run.seed, "sight", sight, key, viewpoint)
                for viewpoint in block.viewpoints
            ]
            for sight in SIGHTS
        }
        seen.append(describe_views(look.rendered, generators))
        features.append(run_phases(block, parameters, tables_for_next(looking, look))["features"])
    views = {cue: np.concatenate([of_block[cue] for of_block in seen]) for cue in CUES}
    return pa.concat_tables(features), views


def sense_all(
    meshes: Sequence[str | Path],
    candidates: pa.Table | None,
    run: ExperimentParameters,
    processes: int,
) -> Sensed:
    """Look at and touch all objects.

    A viewpoint from which any strategy lacks touches is left out for all strategies. Classes with one object are left
    out. `candidates` is the table of `make_candidates`, or None without strategy `ADAPTIVE`.
    """
    usable, touches = usable_meshes(meshes), most_touches(run)
    sensed = Parallel(processes)(delayed(sense_object)(mesh, run) for mesh in usable)
    views = {object_of(mesh): seen for mesh, (_, seen) in zip(usable, sensed, strict=True)}
    rows = pa.concat_tables([features for features, _ in sensed])
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
    keys = ["/".join(sequences.objects[index]) for index in sequences.object_index]
    key_and_view = list(zip(keys, sequences.viewpoint, strict=True))
    seen = {cue: np.stack([views[key][cue][view] for key, view in key_and_view]) for cue in CUES}
    touched = {strategy: by_strategy.features for strategy, by_strategy in gathered.items()}
    names = sequences.feature_names
    chosen = None if candidates is None else gather_candidates(candidates, names)
    return Sensed(sequences, seen, touched, chosen)


def _both(table: pa.Table, other: pa.Table) -> pa.Table:
    """Return the rows of a table whose viewpoints are also in the other table."""
    keys = ["class", "object", "viewpoint"]
    viewpoints = other.group_by(keys).aggregate([])
    return table.join(viewpoints, keys, join_type="left semi").select(table.column_names)
