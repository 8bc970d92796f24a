"""The table of answers by eye, by touch and by both senses."""

from __future__ import annotations

import pyarrow as pa

from visuohaptic.tables.phases import OBJECT_KEYS
from visuohaptic.tables.schema import REAL, TEXT, Column, Schema, count, share

CONFIDENCE_BINS = 10
"""Number of equal bins of probability over which calibration is measured."""

EYE_AND_TOUCH = Schema(
    "eye_and_touch",
    (
        Column("sight", TEXT, "how well the eye saw"),
        Column(
            "answer",
            TEXT,
            "by which senses: the view, the outline, touch, product or side by side of view and touch, or stopping: the product where the rule stops",
        ),
        Column("strategy", TEXT, "how the places to touch were chosen; none without touches"),
        count("touches", "touches of a trial, at most"),
        Column(
            "budget",
            REAL,
            "of the rule that stops: mean time of its rehearsals",
            "s",
            0,
            nullable=True,
        ),
        *OBJECT_KEYS,
        count("split", "number of the split"),
        count("repeat", "number of the repeat"),
    ),
    (
        count("trials", "viewpoints that were tested", 1),
        share("accuracy", "share of them that is correctly classified"),
        Column("seconds", REAL, "mean time that the robot took, without computing", "s", 0),
        Column(
            "gaps",
            pa.list_(pa.float64()),
            "in each tenth of the probability of the class: sum over trials of correct (0, 1) less that probability",
        ),
    ),
)
