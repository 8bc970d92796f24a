"""The table of numerical checks on each object of a run: the largest error and its tolerance."""

from __future__ import annotations

import pyarrow as pa

from visuohaptic.tables.phases import OBJECT_KEYS
from visuohaptic.tables.schema import REAL, TEXT, Column, Schema

STABILITY = Schema(
    "stability",
    (
        *OBJECT_KEYS,
        Column("requirement", TEXT, "the requirement"),
    ),
    (
        Column("cases", pa.int64(), "cases tried", minimum=1),
        Column(
            "worst_error",
            REAL,
            "largest error of all cases; missing if infinite or not a number",
            "as in the column unit",
            nullable=True,
        ),
        Column("tolerance", REAL, "largest allowed error", "as in the column unit", 0),
        Column("unit", TEXT, "unit of error and tolerance"),
        Column("reason", TEXT, "reason for the tolerance"),
        Column("hardest", TEXT, "the case with the largest error"),
    ),
)
