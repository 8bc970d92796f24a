"""The table of accuracies per turned object."""

from __future__ import annotations

import pyarrow as pa

from visuohaptic.tables.phases import CELL_KEYS, OBJECT_KEYS
from visuohaptic.tables.schema import REAL, TEXT, Column, Schema, count, share

TURNED = Schema(
    "turned",
    (
        Column("turns", TEXT, "how the objects were turned, as meshes.turns"),
        Column("known", TEXT, "the known part of the object's frame"),
        count("touches", "touches per sequence", 1),
        *CELL_KEYS,
        *OBJECT_KEYS,
    ),
    (
        count("draws", "draws of the turns over which the accuracy is a mean", 1),
        share("accuracy", "share of the object's test sequences that is correctly classified"),
        Column("weight", REAL, "weight of the object in the mean over splits", "", 0),
        Column(
            "held_out",
            pa.bool_(),
            "whether the object took no part in choosing descriptors and settings",
        ),
    ),
)
"""Column ``pipeline`` also has ``literal``: the paper's pipeline in the most literal variant of the paper."""
