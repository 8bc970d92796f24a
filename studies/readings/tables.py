"""The table of readings: a row a reading, a kind of random touches, and a classifier."""

from __future__ import annotations

from readings.choices import BY_NAME
from visuohaptic.tables.schema import COUNT, REAL, TEXT, Column, Schema, names_of
from visuohaptic.tables.studies import ERROR, SECONDS

READING_KEYS = (
    Column("reading", TEXT, "name of the reading"),
    Column("random_probing", TEXT, "random touches that fixation is compared with, as an option"),
    Column("classifier", TEXT, "the classifier"),
)

READINGS = Schema(
    "readings",
    READING_KEYS,
    (
        Column("part", TEXT, "part of the design that it belongs to"),
        Column("place", COUNT, "place of the reading in the design", minimum=0),
        *(
            Column(name, TEXT, "option of this choice")
            for name in BY_NAME
            if name not in names_of(READING_KEYS)
        ),
        *(
            Column(f"{strategy}{end}", REAL, f"{text} by {words}", "1", 0, 1, nullable=True)
            for strategy, words in (("fixation", "fixation"), ("random", "option random_probing"))
            for end, text in (
                ("", "share of test sequences correctly classified, touches"),
                ("_low", "lower end of its interval over objects, touches"),
                ("_high", "upper end of its interval over objects, touches"),
                ("_best_split", "the same share in the best split, touches"),
                ("_splits_reaching", "share of splits at or above the paper's figure, touches"),
            )
        ),
        Column(
            "ahead",
            REAL,
            "fixation less random, by option random_probing",
            "1",
            -1,
            1,
            nullable=True,
        ),
        Column("ahead_low", REAL, "lower end of its interval", "1", -1, 1, nullable=True),
        Column("ahead_high", REAL, "upper end of its interval", "1", -1, 1, nullable=True),
        Column("p_value", REAL, "two-sided, sign changes over objects", "1", 0, 1, nullable=True),
        Column("objects", COUNT, "objects tested", minimum=1, nullable=True),
        Column("splits", COUNT, "splits", minimum=1, nullable=True),
        SECONDS,
        ERROR,
    ),
)
