"""The tables that the studies make."""

from __future__ import annotations

from dataclasses import replace

import pyarrow as pa

from visuohaptic.tables.phases import CELL_KEYS, OBJECT_KEYS
from visuohaptic.tables.schema import REAL, TEXT, Column, Schema, count, difference, share

EFFECT_INFLUENCE = Schema(
    "effect_influence",
    (
        Column(
            "scene", TEXT, "preset of the scene, or any: effects of the view, which no preset sets"
        ),
        Column("effect", TEXT, "what may be simulated"),
    ),
    (
        count("touches", "touches measured; views, for effects of the view", 1),
        count("needed", "of them, those that needed the effect"),
        Column("seconds", REAL, "time spent on it under the scene's own mode", "s of processor", 0),
        Column("seconds_always", REAL, "time spent on it under always", "s of processor", 0),
        share("image_shift", "mean change of a pixel of the image without it"),
        Column(
            "equal_to_always",
            pa.bool_(),
            "whether images under auto are those under always, bit for bit; missing if an effect is off",
            nullable=True,
        ),
    ),
)

STUDY_KEYS = (
    Column("study", TEXT, "the study"),
    Column("condition", TEXT, "what differs from the run"),
    *CELL_KEYS,
)

ERROR = Column("error", TEXT, "why the condition could not be run", nullable=True)
SECONDS = Column(
    "seconds", REAL, "training and testing all splits", "s of processor", 0, nullable=True
)
_OBJECTS = count("objects", "objects tested", 1, nullable=True)
P_VALUE = share("p_value", "two-sided, sign changes over objects", nullable=True)

STUDY = Schema(
    "study",
    (
        *STUDY_KEYS,
        *(replace(column, nullable=True) for column in OBJECT_KEYS),
        count("split", "number of the train and test split", nullable=True),
        count("repeat", "repeat with another seed", nullable=True),
    ),
    (
        count("sequences", "test sequences; 1 where viewpoints vote", 1, nullable=True),
        share("accuracy", "share of them that is correctly classified", nullable=True),
        SECONDS,
        ERROR,
    ),
)

STUDY_FIGURES = Schema(
    "study_figures",
    STUDY_KEYS,
    (
        Column("title", TEXT, "what the study is about"),
        count("place", "place of the condition in its study"),
        share("accuracy", "share of test sequences correctly classified", nullable=True),
        share("low", "lower end of its interval over objects", nullable=True),
        share("high", "upper end of its interval over objects", nullable=True),
        Column("compared_with", TEXT, "the condition that it is compared with", nullable=True),
        *difference("difference", "accuracy less that of the other"),
        P_VALUE,
        share("adjusted_p", "p value adjusted by Holm for the study's conditions", nullable=True),
        *difference(
            "lead", "accuracy by fixation, in the same condition, less that by this strategy"
        ),
        replace(P_VALUE, name="lead_p"),
        _OBJECTS,
        Column("recomputed", TEXT, "first phase that is recomputed, or recognition"),
        SECONDS,
        ERROR,
    ),
)

CLASSIFIED_BY = Column("classifier", TEXT, "classifier of pipeline order_free")
VIEWS = count("views", "viewpoints from which it is classified", 1)
ANSWER = (
    Column("known", pa.bool_(), "whether the object is of a class that the model knows"),
    Column("correct", pa.bool_(), "whether the likeliest class is its own"),
    Column("covered", pa.bool_(), "whether the prediction set holds its class"),
)
CANDIDATES = count("candidates", "classes in the prediction set")
UNKNOWN = Column("unknown", pa.bool_(), "whether the object is called unknown")

EVALUATION = Schema(
    "evaluation",
    (
        Column("strategy", TEXT, "whose touches, those that the model learnt from"),
        CLASSIFIED_BY,
        Column("class", TEXT, "class of the object"),
        Column("object", TEXT, "name of the object, which the model has not learnt"),
        VIEWS,
        count("bag", "which of the evenly spread choices of so many viewpoints"),
    ),
    (
        *ANSWER,
        CANDIDATES,
        UNKNOWN,
        share("stated", "stated coverage of the prediction set"),
        count("learnt", "objects that the model learnt", 2),
    ),
)

COST_KEYS = (
    Column("family", TEXT, "what varies"),
    Column("setting", TEXT, "to which value"),
)

COST_PARTS = (
    ("seconds_look", "of it: preparing the surface for rays, rendering and attention"),
    ("seconds_touch", "of it: touching"),
    ("seconds_describe", "of it: features"),
    ("seconds_classify", "of it: classification"),
    ("seconds_render", "of looking: rendering the views"),
    ("seconds_attend", "of looking: saliency and fixations"),
    ("seconds_cast", "of touching: casting rays"),
)

COST_SECONDS = Schema(
    "cost_seconds",
    (
        *COST_KEYS,
        Column("object", TEXT, "class and name of the object, with a slash between"),
        count("turn", "the settings' turn; each sees the object from another side"),
    ),
    (
        Column("seconds", REAL, "run time of one recognition", "s", 0),
        *(Column(name, REAL, text, "s", 0) for name, text in COST_PARTS),
    ),
)

COST = Schema(
    "cost",
    COST_KEYS,
    (
        count("place", "place along the family's line"),
        count("touches", "touches from each viewpoint", 1),
        count("viewpoints", "viewpoints that vote", 1),
        count("looks", "views that must be looked at; none for a blind strategy"),
        Column("strategy", TEXT, "how the probing locations were chosen"),
        Column("pipeline", TEXT, "how features become an answer"),
        Column("classifier", TEXT, "the classifier"),
        Column("changes", TEXT, "other parameters that differ from the run's, JSON"),
        share("error", "share of recognitions that are wrong", nullable=True),
        share("error_low", "lower end of its interval over objects", nullable=True),
        share("error_high", "upper end of its interval over objects", nullable=True),
        *difference("lost", "error rate less that of the run's own setting from one viewpoint"),
        count("objects", "objects that were tested", 1, nullable=True),
        Column("failed", TEXT, "why it could not be run", nullable=True),
        Column("seconds", REAL, "run time of a recognition, median of all", "s", 0, nullable=True),
        Column("seconds_low", REAL, "its lower quartile", "s", 0, nullable=True),
        Column("seconds_high", REAL, "its upper quartile", "s", 0, nullable=True),
        *(
            Column(name, REAL, f"{text}, median", "s", 0, nullable=True)
            for name, text in COST_PARTS
        ),
        count("recognitions", "recognitions that were timed", 1, nullable=True),
        Column(
            "as_quick", pa.bool_(), "whether it is not significantly slower than the quickest one"
        ),
        Column("on_front", pa.bool_(), "whether no other setting is quicker and as accurate"),
        Column("dominated", pa.bool_(), "whether another one is at least as good in both"),
        Column(
            "step",
            pa.bool_(),
            "whether it is the most accurate of those as quick as the quickest, or significantly slower and significantly more accurate than the step before",
        ),
        Column(
            "quicker", pa.bool_(), "whether it is significantly quicker than the run's own setting"
        ),
    ),
)

STUDIES = (
    STUDY,
    STUDY_FIGURES,
    EFFECT_INFLUENCE,
    COST_SECONDS,
    COST,
    EVALUATION,
)
