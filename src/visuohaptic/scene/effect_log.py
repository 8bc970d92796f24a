"""The effect log: why each effect was needed, how often it ran, and its run time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields

import pyarrow as pa

from visuohaptic.scene.records import EffectRecord
from visuohaptic.tables.phases import EFFECTS, owner_columns
from visuohaptic.tables.schema import build_table


def effect_table(
    key: str, first_viewpoint: int, scene: str, records: Sequence[EffectRecord]
) -> pa.Table:
    """Return the records of one job as rows of `tables.EFFECTS`, one row per effect.

    `key` is the object, ``class/name``. `first_viewpoint` is the first viewpoint of the job. `scene` is the name of the
    scene's preset, or ``any`` for effects that no preset sets.
    """
    columns = owner_columns(key) | {"first_viewpoint": first_viewpoint, "scene": scene}
    for field in fields(EffectRecord):
        columns[field.name] = [getattr(record, field.name) for record in records]
    return build_table(EFFECTS, columns)
