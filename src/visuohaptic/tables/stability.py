"""The table of numerical checks on each object of a run: the worst error beside its tolerance."""

from __future__ import annotations

import pyarrow as pa

from visuohaptic.tables.phases import OBJECT_KEYS
from visuohaptic.tables.schema import REAL, TEXT, Column, Schema

STABILITY = Schema(
    "stability",
    (
        *OBJECT_KEYS,
        Column("requirement", TEXT, "what is required"),
    ),
    (
        Column("cases", pa.int64(), "cases that were tried", minimum=1),
        Column(
            "worst_error",
            REAL,
            "largest error of a case; missing where it was infinite or not a number",
            "as in the column unit",
            nullable=True,
        ),
        Column("tolerance", REAL, "largest error that is allowed", "as in the column unit", 0),
        Column("unit", TEXT, "unit of error and tolerance"),
        Column("reason", TEXT, "why the tolerance is what it is"),
        Column("hardest", TEXT, "the case with the largest error"),
    ),
)
