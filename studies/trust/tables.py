"""The table of answers of models that lack a class, for objects of known and of unknown classes."""

from __future__ import annotations

import pyarrow as pa

from visuohaptic.tables.schema import REAL, TEXT, Column, Schema, share
from visuohaptic.tables.studies import ANSWER, CANDIDATES, CLASSIFIED_BY, UNKNOWN, VIEWS

STATED_COVERAGES = tuple(range(50, 100, 5))
"""Coverages at which prediction sets are measured, percent."""

TRUST = Schema(
    "trust",
    (
        Column("strategy", TEXT, "whose touches"),
        CLASSIFIED_BY,
        Column("left_out", TEXT, "the class that the model does not know"),
        Column("class", TEXT, "class of the tested object"),
        Column("object", TEXT, "name of the tested object"),
        VIEWS,
    ),
    (
        *ANSWER,
        Column(
            "covered_at",
            pa.list_(pa.int32()),
            f"stated coverages, of {STATED_COVERAGES[0]}, {STATED_COVERAGES[1]} to {STATED_COVERAGES[-1]}, whose set holds its class",
            "percent",
            STATED_COVERAGES[0],
            STATED_COVERAGES[-1],
        ),
        CANDIDATES,
        share("novelty_rank", "share of known objects that are less strange"),
        Column("evidence", REAL, "distance from the nearest training object; larger is stranger"),
        UNKNOWN,
    ),
)
