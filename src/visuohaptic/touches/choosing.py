"""The choice among a view's probing locations: reach, spare locations and length of the sequence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.base.arrays import BoolArray, IntArray
from visuohaptic.base.bounded_loops import turns
from visuohaptic.fixations.places import Unreachable
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.reaching import reachable
from visuohaptic.tables.phases import NORMAL_NAMES, POINT_NAMES, SPARE, TOUCH_KEYS
from visuohaptic.tables.schema import matrix, names_of


@dataclass(frozen=True)
class Wanted:
    """The most touches of a sequence, and parameters of section `probing`."""

    touches: int
    unreachable: Unreachable = "replace"
    when_exhausted: Literal["stop", "begin_again"] = "stop"


def choose_locations(
    caster: RayCaster, fixations: pa.Table, sensor: SensorParameters, wanted: Wanted
) -> tuple[pa.Table, IntArray]:
    """Choose the probing locations that are touched.

    A sequence takes its first locations. If locations out of reach are replaced, it skips them, at most `SPARE`,
    and takes the next locations. If they are skipped, it takes those in reach among its first `wanted.touches`
    locations. So a sequence with fewer touches is a prefix of a longer sequence.

    Parameters
    ----------
    caster : RayCaster
        The object's surface, prepared for rays.
    fixations : pyarrow.Table
        Rows of `tables.FIXATIONS`, in order within each sequence. Column ``unreachable`` overrides
        `wanted.unreachable`.
    sensor : SensorParameters
        The sensor.
    wanted : Wanted
        The touches of a sequence.

    Returns
    -------
    chosen : pyarrow.Table
        The chosen rows, with column ``touch`` counted anew.
    ranks : ndarray of shape (n,), int64
        Column ``touch`` of the chosen rows before.
    """
    ranks = fixations.column("touch").to_numpy().astype(np.int64)
    when_unreachable = pc.fill_null(fixations.column("unreachable"), wanted.unreachable)
    unchecked = np.array(pc.not_equal(when_unreachable, "keep"), dtype=bool)
    skips = np.array(pc.equal(when_unreachable, "skip"), dtype=bool)
    allowed = np.ones(len(ranks), dtype=bool)
    # Each turn but the last checks a row at least.
    for _ in turns(len(ranks) + 1, "the choice of locations in reach"):
        numbers = _counts_before(allowed, ranks)
        taken = (numbers < wanted.touches) & (ranks - numbers <= SPARE)
        chosen = allowed & np.where(skips, ranks < wanted.touches, taken)
        to_check = np.flatnonzero(chosen & unchecked)
        if not len(to_check):
            break
        unchecked[to_check] = False
        allowed[to_check] = in_reach(caster, fixations.take(to_check), sensor)
    rows, numbers = np.flatnonzero(chosen), numbers[chosen]
    if wanted.when_exhausted == "begin_again":
        rows, numbers = _begin_again(rows, numbers, wanted.touches)
    return with_touch_numbers(fixations.take(rows), numbers), ranks[rows]


def touched_locations(fixations: pa.Table, touches: pa.Table) -> pa.Table:
    """Return the probing location of each touch, in the order of the touches.

    The result are rows of `tables.FIXATIONS` with column ``touch`` of `touches`, rows of `tables.TOUCHES`.
    """
    owner = [name for name in names_of(TOUCH_KEYS) if name != "touch"]
    rows = {key: row for row, key in enumerate(_keys(fixations, [*owner, "touch"]))}
    touched = fixations.take([rows[key] for key in _keys(touches, [*owner, "rank"])])
    return with_touch_numbers(touched, touches.column("touch").to_numpy())


def with_touch_numbers(fixations: pa.Table, numbers: IntArray) -> pa.Table:
    """Replace column ``touch`` of rows of `tables.FIXATIONS` by numbers (n,)."""
    index = fixations.schema.get_field_index("touch")
    field = fixations.schema.field("touch")
    return fixations.set_column(index, field, pa.array(numbers, field.type))


def _counts_before(counted: BoolArray, ranks: IntArray) -> IntArray:
    """Count, for each row, the earlier rows of its sequence with `counted` true."""
    before: IntArray = np.cumsum(counted) - counted
    starts = np.flatnonzero(ranks == 0)
    lengths = np.diff(np.append(starts, len(ranks)))
    return before - np.repeat(before[starts], lengths)


def in_reach(caster: RayCaster, fixations: pa.Table, sensor: SensorParameters) -> BoolArray:
    """Return whether the sensor can reach each of n rows of `tables.FIXATIONS`: shape (n,), bool."""
    points, normals = matrix(fixations, POINT_NAMES), matrix(fixations, NORMAL_NAMES)
    return reachable(caster, points, normals, sensor, fixations.column("face").to_numpy())


def _begin_again(rows: IntArray, numbers: IntArray, touches: int) -> tuple[IntArray, IntArray]:
    """Extend each sequence to `touches` rows by repeating it from its first location."""
    sequences = np.split(rows, np.flatnonzero(numbers == 0)[1:])
    extended = [np.resize(sequence, touches) for sequence in sequences if len(sequence)]
    return np.concatenate([rows[:0], *extended]), np.tile(np.arange(touches), len(extended))


def _keys(table: pa.Table, names: Sequence[str]) -> list[tuple[object, ...]]:
    return list(zip(*(table.column(name).to_pylist() for name in names), strict=True))
