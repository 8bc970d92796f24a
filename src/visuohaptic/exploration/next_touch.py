"""One more touch at a given point, and what was felt there."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import lru_cache

import numpy as np
import pyarrow as pa
from numpy.typing import ArrayLike

from visuohaptic.base.errors import ParameterError
from visuohaptic.exploration.touching import GIVEN, SCHEMAS, Explored, given_places
from visuohaptic.features.describing import describe_touches
from visuohaptic.fixations.locations import location_table
from visuohaptic.fixations.policies import Felt
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.io.phase_files import Tables
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.scene.effect_log import effect_table
from visuohaptic.scene.records import EffectRecord, merge_records
from visuohaptic.tables.phases import FEATURES, NORMAL_NAMES
from visuohaptic.tables.schema import images, join_parts, matrix
from visuohaptic.touches.choosing import in_reach, with_touch_numbers
from visuohaptic.touches.touching import touch_part


@dataclass(frozen=True, eq=False)
class FeltTouch(Felt):
    """What one touch felt, and its features by their columns in `tables.FEATURES`."""

    features: Mapping[str, float | str] = field(default_factory=dict)


def touch_next_point(
    key: str,
    surface: Surface,
    point: ArrayLike,
    normal: ArrayLike | None,
    parameters: ExperimentParameters,
    known: Tables,
) -> tuple[Explored, FeltTouch]:
    """Touch an object at one more point (3,), as `Exploration.touch_next` describes it.

    `known` are the tables of touches at given points. Returns the tables of all touches with the seconds of the last
    one, and what was felt.
    """
    started = time.perf_counter()
    caster = _caster_of(surface)
    normals = None if normal is None else _one_row(normal, "normal")
    places, chosen = given_places(caster, _one_row(point, "point"), normals, parameters)
    number = np.array([known["touches"].num_rows])
    located = with_touch_numbers(location_table(key, 0, GIVEN, places), number)
    acquired = bool(in_reach(caster, located, chosen.sensor)[0])
    touches, records = touch_part(caster, located, chosen.sensor, chosen.scene, chosen.seed)
    touched = time.perf_counter()
    features = describe_touches(touches, chosen.features)
    seconds = {"touch": touched - started, "describe": time.perf_counter() - touched}
    new = {"fixations": located, "touches": touches, "features": features}
    tables = {name: join_parts(SCHEMAS[name], [known[name], part]) for name, part in new.items()}
    log = effect_table(key, 0, chosen.scene.preset, _added(known["effects"], records))
    tables |= {"views": known["views"], "effects": join_parts(SCHEMAS["effects"], [log])}
    (row,) = features.to_pylist()
    felt = FeltTouch(
        places.points[0],
        matrix(touches, NORMAL_NAMES)[0],
        acquired,
        images(touches)[0],
        row["sensor_size"],
        row["contact_state"],
        {name: value for name, value in row.items() if name not in FEATURES.keys},
    )
    return (tables, seconds), felt


@lru_cache(maxsize=1)
def _caster_of(surface: Surface) -> RayCaster:
    """Prepare a surface for rays once for all touches that follow each other."""
    return RayCaster(surface)


def _one_row(values: ArrayLike, name: str) -> ArrayLike:
    try:
        row = np.asarray(values)
    except ValueError:
        raise ParameterError(f"{name} holds no numbers; an array of them is needed.") from None
    if row.shape != (3,):
        raise ParameterError(f"{name} has the shape {row.shape}; (3,) is needed.")
    return row[None]


def _added(log: pa.Table, records: Sequence[EffectRecord]) -> tuple[EffectRecord, ...]:
    """Add the records of a touch to those of a log, `tables.EFFECTS`."""
    names = [one.name for one in fields(EffectRecord)]
    before = {row["effect"]: row for row in log.to_pylist()}
    earlier = [
        EffectRecord(**{name: before[one.effect][name] for name in names}) for one in records
    ]
    return merge_records([earlier, records])
