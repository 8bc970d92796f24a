"""The table of a run's guards."""

from __future__ import annotations

from visuohaptic.tables.schema import TEXT, Column, Schema, names_of

GUARDS_KEYS = (Column("guard", TEXT, "what must hold for the report's claim"),)

GUARDS = Schema(
    "guards",
    (
        *GUARDS_KEYS,
        Column("outcome", TEXT, "held, failed or not tested"),
        Column("found", TEXT, "what was found, or why nothing was tested"),
    ),
    names_of(GUARDS_KEYS),
)
