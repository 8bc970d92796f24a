"""The table of variants: one row per variant, kind of random touches, and classifier."""

from __future__ import annotations

from variants.choices import BY_NAME
from visuohaptic.tables.schema import REAL, TEXT, Column, Schema, count, names_of, share
from visuohaptic.tables.studies import ERROR, SECONDS

VARIANT_KEYS = (
    Column("variant", TEXT, "name of the variant"),
    Column("random_probing", TEXT, "random touches that fixation is compared with, as an option"),
    Column("classifier", TEXT, "the classifier"),
)

VARIANTS = Schema(
    "variants",
    VARIANT_KEYS,
    (
        Column("part", TEXT, "part of the design that it belongs to"),
        count("place", "place of the variant in the design"),
        *(
            Column(name, TEXT, "option of this choice")
            for name in BY_NAME
            if name not in names_of(VARIANT_KEYS)
        ),
        *(
            share(f"{strategy}{end}", f"{text} by {words}", nullable=True)
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
        share("p_value", "two-sided, sign changes over objects", nullable=True),
        count("objects", "objects tested", 1, nullable=True),
        count("splits", "splits", 1, nullable=True),
        SECONDS,
        ERROR,
    ),
)
