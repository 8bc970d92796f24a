"""The table of answers to new touches of known objects."""

from __future__ import annotations

import pyarrow as pa

from visuohaptic.tables.phases import VIEW_KEYS
from visuohaptic.tables.schema import TEXT, Column, Schema, count, share

KNOWN_OBJECTS = Schema(
    "known_objects",
    (
        Column("strategy", TEXT, "how the probing locations were chosen"),
        count("turn", "turn of the object, 0 first"),
        *VIEW_KEYS,
        count("touches", "touches made before the answer", 1),
    ),
    (
        Column("answer", TEXT, "class/name of the most probable object"),
        share("probability", "calibrated probability of the answer"),
        Column("correct", pa.bool_(), "whether the answer is the touched object"),
    ),
)
