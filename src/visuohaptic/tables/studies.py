"""The tables that the studies make."""

from __future__ import annotations

import pyarrow as pa

from visuohaptic.tables.phases import OBJECT_KEYS
from visuohaptic.tables.schema import COUNT, REAL, TEXT, Column, Schema, names_of

EFFECT_INFLUENCE_KEYS = (
    Column("scene", TEXT, "preset of the scene, or any: effects of the view, which no preset sets"),
    Column("effect", TEXT, "what may be simulated"),
)

EFFECT_INFLUENCE = Schema(
    "effect_influence",
    (
        *EFFECT_INFLUENCE_KEYS,
        Column("touches", COUNT, "touches measured; views, for effects of the view", minimum=1),
        Column("seconds", REAL, "time spent on it under the scene's own mode", "s", 0),
        Column("seconds_always", REAL, "time spent on it under always", "s", 0),
        Column("image_shift", REAL, "mean change of a pixel of the image without it", "1", 0, 1),
    ),
    names_of(EFFECT_INFLUENCE_KEYS),
)

EFFECT_ACCURACY_KEYS = (
    Column("scene", TEXT, "preset of the scene"),
    Column("without", TEXT, "the effect that is left out, or nothing"),
    Column("strategy", TEXT, "how the probing locations were chosen"),
)

EFFECT_ACCURACY = Schema(
    "effect_accuracy",
    (
        *EFFECT_ACCURACY_KEYS,
        Column("pipeline", TEXT, "how features become an answer"),
        Column("classifier", TEXT, "the classifier"),
        Column("accuracy", REAL, "share of test sequences named rightly", "1", 0, 1),
        Column("low", REAL, "lower end of its interval over objects", "1", 0, 1),
        Column("high", REAL, "upper end of its interval over objects", "1", 0, 1),
    ),
    names_of(EFFECT_ACCURACY_KEYS),
)

CURVE_KEYS = (
    Column("pipeline", TEXT, "how features become an answer"),
    Column("strategy", TEXT, "how the probing locations were chosen"),
    Column("classifier", TEXT, "the classifier"),
    Column("touches", COUNT, "touches of a sequence, the first ones", minimum=1),
)

CURVES = Schema(
    "curves",
    (
        *CURVE_KEYS,
        *OBJECT_KEYS,
        Column("accuracy", REAL, "share of the object's test sequences named rightly", "1", 0, 1),
        Column("weight", REAL, "the object's weight in a mean over splits", minimum=0),
    ),
    names_of((*CURVE_KEYS, *OBJECT_KEYS)),
)

TOUCH_CURVES = Schema(
    "touch_curves",
    (
        *CURVE_KEYS,
        Column("accuracy", REAL, "share of test sequences named rightly", "1", 0, 1),
        Column("low", REAL, "lower end of its interval over objects", "1", 0, 1),
        Column("high", REAL, "upper end of its interval over objects", "1", 0, 1),
    ),
    names_of(CURVE_KEYS),
)

TOUCHES_NEEDED_KEYS = CURVE_KEYS[:3]

TOUCHES_NEEDED = Schema(
    "touches_needed",
    (
        *TOUCHES_NEEDED_KEYS,
        Column("level", REAL, "the accuracy to be reached", "1", 0, 1),
        Column(
            "touches",
            COUNT,
            "touches from which on accuracy stays at it; missing if never",
            minimum=1,
            nullable=True,
        ),
        Column(
            "touches_low",
            COUNT,
            "touches from which on its interval's upper end stays at it; missing if never",
            minimum=1,
            nullable=True,
        ),
        Column(
            "touches_high",
            COUNT,
            "touches from which on its interval's lower end stays at it; missing if never",
            minimum=1,
            nullable=True,
        ),
        Column("most_touches", COUNT, "touches at the curve's end", minimum=1),
        Column("area", REAL, "area under the curve", "of accuracy 1 throughout", 0, 1),
        Column("area_low", REAL, "lower end of its interval over objects", "1", 0, 1),
        Column("area_high", REAL, "upper end of its interval over objects", "1", 0, 1),
        Column(
            "gain", REAL, "area under fixation's curve less this one", "1", -1, 1, nullable=True
        ),
        Column("gain_low", REAL, "lower end of its interval", "1", -1, 1, nullable=True),
        Column("gain_high", REAL, "upper end of its interval", "1", -1, 1, nullable=True),
        Column("p_value", REAL, "two-sided, sign changes over objects", "1", 0, 1, nullable=True),
        Column("objects", COUNT, "objects compared", minimum=1),
    ),
    names_of(TOUCHES_NEEDED_KEYS),
)

ABLATION_KEYS = (
    Column("ablation", TEXT, "what is left out or exchanged"),
    Column("pipeline", TEXT, "how features become an answer"),
    Column("classifier", TEXT, "the classifier"),
)

ABLATION_SECONDS = (
    Column(
        "making_seconds",
        REAL,
        "looking, touching and describing what is made anew",
        "s of processor",
        0,
    ),
    Column("naming_seconds", REAL, "training and testing all splits", "s of processor", 0),
)

ABLATION = Schema(
    "ablation",
    (
        *ABLATION_KEYS,
        *OBJECT_KEYS,
        Column("accuracy", REAL, "share of the object's test sequences named rightly", "1", 0, 1),
        Column("weight", REAL, "the object's weight in a mean over splits", minimum=0),
        *ABLATION_SECONDS,
    ),
    names_of((*ABLATION_KEYS, *OBJECT_KEYS)),
)

ABLATIONS = Schema(
    "ablations",
    (
        *ABLATION_KEYS,
        Column("group", TEXT, "what it is one of"),
        Column("remade", TEXT, "what is made anew: nothing, descriptors, touches or views"),
        Column("accuracy", REAL, "share of test sequences named rightly", "1", 0, 1),
        Column("low", REAL, "lower end of its interval over objects", "1", 0, 1),
        Column("high", REAL, "upper end of its interval over objects", "1", 0, 1),
        Column("loss", REAL, "accuracy of the whole method less this one", "1", -1, 1),
        Column("loss_low", REAL, "lower end of its interval over objects", "1", -1, 1),
        Column("loss_high", REAL, "upper end of its interval over objects", "1", -1, 1),
        Column("p_value", REAL, "two-sided, sign changes over objects", "1", 0, 1),
        *ABLATION_SECONDS,
        Column("objects", COUNT, "objects compared", minimum=1),
    ),
    names_of(ABLATION_KEYS),
)

COST_KEYS = (
    Column("family", TEXT, "what varies"),
    Column("setting", TEXT, "to which value"),
)

COST_SECONDS_COLUMNS = (
    ("seconds", "what a recognition takes, median"),
    ("seconds_low", "its lower quartile"),
    ("seconds_high", "its upper quartile"),
    ("seconds_look", "of it: making views, looking at them"),
    ("seconds_touch", "of it: touching"),
    ("seconds_describe", "of it: features"),
    ("seconds_name", "of it: classification"),
)

COST_SECONDS = Schema(
    "cost_seconds",
    (
        *COST_KEYS,
        *(Column(name, REAL, text, "s", 0) for name, text in COST_SECONDS_COLUMNS),
        Column("recognitions", COUNT, "recognitions that were timed", minimum=1),
    ),
    names_of(COST_KEYS),
)

COST_ERRORS = Schema(
    "cost_errors",
    (
        *COST_KEYS,
        Column("place", COUNT, "place along the family's line", minimum=0),
        Column("touches", COUNT, "touches from each viewpoint", minimum=1),
        Column("viewpoints", COUNT, "viewpoints that vote", minimum=1),
        Column("pipeline", TEXT, "how features become an answer"),
        Column("classifier", TEXT, "the classifier"),
        Column("changes", TEXT, "other parameters that differ from the run's, JSON"),
        Column("error", REAL, "share of recognitions that name wrongly", "1", 0, 1, nullable=True),
        Column(
            "error_low",
            REAL,
            "lower end of its interval over objects",
            "1",
            0,
            1,
            nullable=True,
        ),
        Column(
            "error_high",
            REAL,
            "upper end of its interval over objects; of no error, the exact binomial one",
            "1",
            0,
            1,
            nullable=True,
        ),
        Column("objects", COUNT, "objects that were tested", minimum=1, nullable=True),
        Column("failed", TEXT, "why it could not be run", nullable=True),
    ),
    names_of(COST_KEYS),
)

COST = Schema(
    "cost",
    (
        *COST_ERRORS.columns,
        *(Column(name, REAL, text, "s", 0, nullable=True) for name, text in COST_SECONDS_COLUMNS),
        Column("recognitions", COUNT, "recognitions that were timed", minimum=1, nullable=True),
        Column("on_front", pa.bool_(), "whether no other setting is quicker and as accurate"),
        Column("dominated", pa.bool_(), "whether another one is at least as good in both"),
    ),
    names_of(COST_KEYS),
)

STUDIES = (
    EFFECT_INFLUENCE,
    EFFECT_ACCURACY,
    CURVES,
    TOUCH_CURVES,
    TOUCHES_NEEDED,
    ABLATION,
    ABLATIONS,
    COST_SECONDS,
    COST_ERRORS,
    COST,
)
