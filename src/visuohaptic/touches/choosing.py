"""Which of a view's probing locations are touched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.base.arrays import BoolArray, IntArray
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.sensor.parameters import SensorParameters
from visuohaptic.sensor.reaching import reachable
from visuohaptic.tables.phases import NORMAL_NAMES, POINT_NAMES, SPARE, TOUCH_KEYS
from visuohaptic.tables.schema import matrix, names_of


@dataclass(frozen=True)
class Wanted:
    """How many touches a sequence has at most, and which, as section `probing` of the parameters says."""

    touches: int
    unreachable: Literal["replace", "keep"] = "replace"
    when_exhausted: Literal["stop", "begin_again"] = "stop"


def choose_places(
    caster: RayCaster, located: pa.Table, sensor: SensorParameters, wanted: Wanted
) -> tuple[pa.Table, IntArray]:
    """Choose the probing locations that are touched, among rows of `tables.FIXATIONS`.

    A sequence takes its first locations. Where those out of reach are replaced, as column
    ``unreachable`` says or else `wanted`, it takes the next ones, and ends before the one that would
    be the `SPARE` + first passed over. So its touches don't depend on how many are asked for.

    Gives the rows with column ``touch`` counted anew, and that column (n,), int64, as it was.
    """
    ranks = located.column("touch").to_numpy().astype(np.int64)
    policy = pc.fill_null(located.column("unreachable"), wanted.unreachable)
    unknown = np.array(pc.equal(policy, "replace"), dtype=bool)
    possible = np.ones(len(ranks), dtype=bool)
    while True:
        places = _counts_before(possible, ranks)
        chosen = possible & (places < wanted.touches) & (ranks - places <= SPARE)
        fresh = np.flatnonzero(chosen & unknown)
        if not len(fresh):
            break
        unknown[fresh] = False
        possible[fresh] = in_reach(caster, located.take(fresh), sensor)
    rows, places = np.flatnonzero(chosen), places[chosen]
    if wanted.when_exhausted == "begin_again":
        rows, places = _begin_again(rows, places, wanted.touches)
    return numbered(located.take(rows), places), ranks[rows]


def touched_places(located: pa.Table, felt: pa.Table) -> pa.Table:
    """Give the probing location of each touch: rows of `tables.FIXATIONS`, with the touches' column ``touch``."""
    owner = [name for name in names_of(TOUCH_KEYS) if name != "touch"]
    rows = {key: row for row, key in enumerate(_keys(located, [*owner, "touch"]))}
    found = located.take([rows[key] for key in _keys(felt, [*owner, "rank"])])
    return numbered(found, felt.column("touch").to_numpy())


def numbered(located: pa.Table, numbers: IntArray) -> pa.Table:
    """Replace the column ``touch`` of rows of `tables.FIXATIONS` by numbers (n,)."""
    place = located.schema.get_field_index("touch")
    field = located.schema.field("touch")
    return located.set_column(place, field, pa.array(numbers, field.type))


def _counts_before(counted: BoolArray, ranks: IntArray) -> IntArray:
    """Count, for each row, the earlier rows of its sequence that count."""
    before: IntArray = np.cumsum(counted) - counted
    starts = np.flatnonzero(ranks == 0)
    lengths = np.diff(np.append(starts, len(ranks)))
    return before - np.repeat(before[starts], lengths)


def in_reach(caster: RayCaster, located: pa.Table, sensor: SensorParameters) -> BoolArray:
    """Find which of n rows of `tables.FIXATIONS` the sensor can reach: shape (n,), bool."""
    points, normals = matrix(located, POINT_NAMES), matrix(located, NORMAL_NAMES)
    return reachable(caster, points, normals, sensor, located.column("face").to_numpy())


def _begin_again(rows: IntArray, places: IntArray, touches: int) -> tuple[IntArray, IntArray]:
    """Make each sequence as long as asked for by starting again at its first place."""
    sequences = np.split(rows, np.flatnonzero(places == 0)[1:])
    longer = [np.resize(sequence, touches) for sequence in sequences if len(sequence)]
    return np.concatenate([rows[:0], *longer]), np.tile(np.arange(touches), len(longer))


def _keys(table: pa.Table, names: Sequence[str]) -> list[tuple[object, ...]]:
    return list(zip(*(table.column(name).to_pylist() for name in names), strict=True))
