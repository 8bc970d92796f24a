"""The table of accuracies per object by cue of a touch."""

from __future__ import annotations

from visuohaptic.tables.phases import CELL_KEYS, OBJECT_KEYS
from visuohaptic.tables.schema import REAL, TEXT, Column, Schema, count, share

ACCURACIES = Schema(
    "cues",
    (
        Column(
            "tested", TEXT, "new objects of known classes, or known objects from new viewpoints"
        ),
        Column("turns", TEXT, "how the objects were turned, as meshes.turns"),
        Column("frame", TEXT, "what is known of the object's pose, as recognition.frame"),
        count("touches", "touches per sequence", 1),
        Column("cues", TEXT, "what is known of a touch"),
        *CELL_KEYS,
        *OBJECT_KEYS,
    ),
    (
        share("accuracy", "share of the object's test sequences that is correctly classified"),
        Column("weight", REAL, "weight of the object in the mean over splits", "", 0),
    ),
)
