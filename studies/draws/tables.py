"""The table of accuracies per object and draw of the random places."""

from __future__ import annotations

from visuohaptic.tables.phases import CELL_KEYS, OBJECT_KEYS
from visuohaptic.tables.schema import REAL, Column, Schema, count, share

DRAWS = Schema(
    "draws",
    (
        *CELL_KEYS,
        count("draw", "index of the draw of the places; fixation has draw 0"),
        *OBJECT_KEYS,
    ),
    (
        share("accuracy", "share of the object's test sequences that is correctly classified"),
        Column("weight", REAL, "weight of the object by fixation in the mean over splits", "", 0),
    ),
)
"""Column ``pipeline`` also has ``literal``: the paper's pipeline in the most literal variant of the paper."""
