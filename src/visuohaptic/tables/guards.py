"""The table of a run's guards."""

from __future__ import annotations

from visuohaptic.tables.schema import TEXT, Column, Schema

GUARDS = Schema(
    "guards",
    (Column("guard", TEXT, "what must hold for the report's claim"),),
    (
        Column("outcome", TEXT, "held, failed or not tested"),
        Column("found", TEXT, "what was found, or why nothing was tested"),
    ),
)
