"""The table of areas under the curves, and of touches needed."""

from __future__ import annotations

from visuohaptic.tables.phases import CELL_KEYS
from visuohaptic.tables.schema import REAL, Column, Schema, count, difference, share
from visuohaptic.tables.studies import P_VALUE, difference_of_classes

TOUCHES_NEEDED = Schema(
    "touches_needed",
    CELL_KEYS,
    (
        share("level", "the accuracy to be reached"),
        *(
            count(
                name,
                f"touches from which on {what} stays at it; missing if never",
                1,
                nullable=True,
            )
            for name, what in (
                ("touches", "accuracy"),
                ("touches_low", "its interval's upper end"),
                ("touches_high", "its interval's lower end"),
            )
        ),
        count("most_touches", "touches at the curve's end", 1),
        Column("area", REAL, "area under the curve", "of accuracy 1 throughout", 0, 1),
        share("area_low", "lower end of its interval over objects"),
        share("area_high", "upper end of its interval over objects"),
        *difference("gain", "area under fixation's curve less this one"),
        P_VALUE,
        *difference_of_classes("gain", "p_value"),
        count("objects", "objects compared", 1),
    ),
)
