"""Add a touch at a given point to the tables of an exploration."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import lru_cache

import numpy as np
import pyarrow as pa
from numpy.typing import ArrayLike

from visuohaptic.active.policies import Felt
from visuohaptic.base.arrays import FloatArray
from visuohaptic.base.errors import ParameterError
from visuohaptic.exploration.checking import numbers
from visuohaptic.exploration.recognising import GIVEN
from visuohaptic.exploration.touching_points import SCHEMAS, Explored, nearest_locations
from visuohaptic.features.describing import describe_touches
from visuohaptic.fixations.locations import location_table
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.io.phase_files import Tables
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.scene.effect_log import effect_table
from visuohaptic.scene.records import EffectRecord, merge_records
from visuohaptic.tables.phases import FEATURES, NORMAL_NAMES
from visuohaptic.tables.schema import join_parts, matrix, readings
from visuohaptic.touches.choosing import in_reach, with_touch_numbers
from visuohaptic.touches.touch_table import touch_part


@dataclass(frozen=True, eq=False)
class FeltTouch(Felt):
    """The result of one touch with its features; the other attributes are those of `Felt`.

    Attributes
    ----------
    features : mapping of str to float or str
        Features of the touch by column of `tables.FEATURES`, without the key columns.
    """

    features: Mapping[str, float | str] = field(default_factory=dict)


def touch_next_point(
    key: str,
    surface: Surface,
    point: ArrayLike,
    normal: ArrayLike | None,
    parameters: ExperimentParameters,
    known: Tables,
) -> tuple[Explored, FeltTouch]:
    """Touch an object at one more point (3,); see `Exploration.touch_next`.

    `known` has the tables of the earlier touches, all at given points. Returns ``((tables, seconds), felt)``: `tables`
    has the earlier touches and the new touch, `seconds` has the wall time of the new touch only, by phase (s).
    """
    started = time.perf_counter()
    caster = _caster_of(surface)
    normals = None if normal is None else _as_row(normal, "normal")
    locations, chosen = nearest_locations(caster, _as_row(point, "point"), normals, parameters)
    number = np.array([known["touches"].num_rows])
    located = with_touch_numbers(location_table(key, {(0, GIVEN): locations}), number)
    acquired = bool(in_reach(caster, located, chosen.sensor)[0])
    touches, records = touch_part(caster, located, chosen.sensor, chosen.scene, chosen.seed)
    touched = time.perf_counter()
    features = describe_touches(touches, chosen.features, chosen.sensor.layout)
    seconds = {"touch": touched - started, "describe": time.perf_counter() - touched}
    new = {"fixations": located, "touches": touches, "features": features}
    tables = {name: join_parts(SCHEMAS[name], [known[name], part]) for name, part in new.items()}
    log = effect_table(key, 0, chosen.scene.preset, _merged_records(known["effects"], records))
    tables |= {"views": known["views"], "effects": join_parts(SCHEMAS["effects"], [log])}
    imprints = readings(touches).reshape(-1, *chosen.sensor.taxels.shape)
    (row,) = features.to_pylist()
    felt = FeltTouch(
        locations.points[0],
        matrix(touches, NORMAL_NAMES)[0],
        acquired,
        imprints[0],
        row["sensor_size"],
        row["contact_state"],
        {name: value for name, value in row.items() if name not in FEATURES.keys},
    )
    return (tables, seconds), felt


@lru_cache(maxsize=1)
def _caster_of(surface: Surface) -> RayCaster:
    """Return the ray caster of a surface. Consecutive touches of the same surface share one caster."""
    return RayCaster(surface)


def _as_row(values: ArrayLike, name: str) -> FloatArray:
    """Return an array (3,) as (1, 3). Raise `ParameterError` about `name` for other shapes, and for no numbers."""
    row = numbers(values, name)
    if row.shape != (3,):
        raise ParameterError(f"{name} has the shape {row.shape}; (3,) is needed.")
    return row[None]


def _merged_records(log: pa.Table, records: Sequence[EffectRecord]) -> tuple[EffectRecord, ...]:
    """Add the records of a touch to those of earlier touches in `log`, rows of `tables.EFFECTS`: one per effect."""
    names = [column.name for column in fields(EffectRecord)]
    before = {row["effect"]: row for row in log.to_pylist()}
    earlier = [
        EffectRecord(**{name: before[record.effect][name] for name in names}) for record in records
    ]
    return merge_records([earlier, records])
