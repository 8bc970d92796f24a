"""The tables that studies write."""

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
        Column("effect", TEXT, "name of the effect"),
    ),
    (
        count("touches", "touches measured; views, for effects of the view", 1),
        count("needed", "touches or views that needed the effect"),
        Column(
            "seconds",
            REAL,
            "time spent on the effect under the scene's own mode",
            "s of processor",
            0,
        ),
        Column(
            "seconds_always",
            REAL,
            "time spent on the effect under mode always",
            "s of processor",
            0,
        ),
        share("image_shift", "mean change of a pixel if the effect is left out"),
        Column(
            "equal_to_always",
            pa.bool_(),
            "whether images under auto equal images under always, bit for bit; missing if an effect is off",
            nullable=True,
        ),
    ),
)

STUDY_KEYS = (
    Column("study", TEXT, "the study"),
    Column("condition", TEXT, "name of the changes to the run"),
    *CELL_KEYS,
)

ERROR = Column("error", TEXT, "why the condition could not be run", nullable=True)
SECONDS = Column(
    "seconds", REAL, "training and testing all splits", "s of processor", 0, nullable=True
)
_OBJECTS = count("objects", "objects tested", 1, nullable=True)
P_VALUE = share("p_value", "two-sided, of new objects of the same classes", nullable=True)


def difference_of_classes(name: str, p_value: str) -> tuple[Column, ...]:
    """Return the columns of the interval of new classes of a difference, and of its p value."""
    low, high = difference(f"{name}_new_classes", "")[1:]
    return (
        replace(low, description="lower end of its interval of new classes"),
        replace(high, description="upper end of its interval of new classes"),
        replace(P_VALUE, name=f"{p_value}_new_classes", description="two-sided, of new classes"),
    )


STUDY = Schema(
    "study",
    (
        *STUDY_KEYS,
        *(replace(column, nullable=True) for column in OBJECT_KEYS),
        count("split", "index of the train and test split", nullable=True),
        count("repeat", "repeat with another seed", nullable=True),
    ),
    (
        count("sequences", "test sequences; 1 where viewpoints vote", 1, nullable=True),
        share("accuracy", "share of the sequences that is correctly classified", nullable=True),
        SECONDS,
        ERROR,
    ),
)

STUDY_FIGURES = Schema(
    "study_figures",
    STUDY_KEYS,
    (
        Column("title", TEXT, "what the study is about"),
        count("place", "index of the condition in its study"),
        share("accuracy", "share of test sequences correctly classified", nullable=True),
        share("low", "lower end of the interval of accuracy over objects", nullable=True),
        share("high", "upper end of the interval of accuracy over objects", nullable=True),
        Column(
            "compared_with", TEXT, "condition that this condition is compared with", nullable=True
        ),
        *difference("difference", "accuracy minus accuracy of the compared condition"),
        P_VALUE,
        *difference_of_classes("difference", "p_value"),
        share("adjusted_p", "p value adjusted by Holm for the study's conditions", nullable=True),
        *difference(
            "lead", "accuracy of fixation in the same condition minus accuracy of this strategy"
        ),
        replace(P_VALUE, name="lead_p"),
        *difference_of_classes("lead", "lead_p"),
        _OBJECTS,
        Column("recomputed", TEXT, "first recomputed phase"),
        SECONDS,
        ERROR,
    ),
)

CLASSIFIED_BY = Column("classifier", TEXT, "classifier of pipeline order_free")
VIEWS = count("views", "viewpoints used to classify the object", 1)
ANSWER = (
    Column("known", pa.bool_(), "whether the model knows the class of the object"),
    Column("correct", pa.bool_(), "whether the likeliest class is the class of the object"),
    Column("covered", pa.bool_(), "whether the prediction set holds the class of the object"),
)
CANDIDATES = count("candidates", "classes in the prediction set")
UNKNOWN = Column("unknown", pa.bool_(), "whether the object is called unknown")

EVALUATION = Schema(
    "evaluation",
    (
        Column("strategy", TEXT, "strategy of the touches, as in training"),
        CLASSIFIED_BY,
        Column("class", TEXT, "class of the object"),
        Column("object", TEXT, "name of the object, which is not in the training set"),
        VIEWS,
        count("bag", "index of the evenly spread choice of viewpoints"),
    ),
    (
        *ANSWER,
        CANDIDATES,
        UNKNOWN,
        share("stated", "stated coverage of the prediction set"),
        count("learnt", "objects in the training set", 2),
    ),
)

COST_KEYS = (
    Column("family", TEXT, "what varies between the settings"),
    Column("setting", TEXT, "value of the setting"),
)

COST_PARTS = (
    ("seconds_look", "time of looking: preparing the ray caster, rendering and attention"),
    ("seconds_touch", "time of touching"),
    ("seconds_describe", "time of features"),
    ("seconds_classify", "time of classification"),
    ("seconds_render", "part of looking: rendering the views"),
    ("seconds_attend", "part of looking: saliency and fixations"),
    ("seconds_cast", "part of touching: casting rays"),
)

COST_SECONDS = Schema(
    "cost_seconds",
    (
        *COST_KEYS,
        Column("object", TEXT, "class and name of the object, with a slash between"),
        count("turn", "index of the repeat; each repeat looks at the object from another side"),
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
        count("place", "index of the setting in its family"),
        count("touches", "touches from each viewpoint", 1),
        count("viewpoints", "viewpoints that vote", 1),
        count("looks", "views to render; 0 for a strategy without views"),
        Column("strategy", TEXT, "how the probing locations were chosen"),
        Column("pipeline", TEXT, "how features become an answer"),
        Column("classifier", TEXT, "the classifier"),
        Column("changes", TEXT, "other parameters that differ from the run's, JSON"),
        share("error", "error rate: share of wrong recognitions", nullable=True),
        share(
            "error_low", "lower end of the interval of the error rate over objects", nullable=True
        ),
        share(
            "error_high", "upper end of the interval of the error rate over objects", nullable=True
        ),
        *difference(
            "lost", "error rate minus error rate of the run's own setting from one viewpoint"
        ),
        count("objects", "tested objects", 1, nullable=True),
        Column("failed", TEXT, "why the setting could not be run", nullable=True),
        Column("seconds", REAL, "run time of a recognition, median", "s", 0, nullable=True),
        Column("seconds_low", REAL, "lower quartile of the run time", "s", 0, nullable=True),
        Column("seconds_high", REAL, "upper quartile of the run time", "s", 0, nullable=True),
        *(
            Column(name, REAL, f"{text}, median", "s", 0, nullable=True)
            for name, text in COST_PARTS
        ),
        count("recognitions", "timed recognitions", 1, nullable=True),
        Column(
            "as_quick",
            pa.bool_(),
            "whether the setting is not significantly slower than the quickest setting",
        ),
        Column("on_front", pa.bool_(), "whether no other setting is quicker and as accurate"),
        Column(
            "dominated", pa.bool_(), "whether another setting is at least as quick and as accurate"
        ),
        Column(
            "step",
            pa.bool_(),
            "whether no setting as quick is more accurate, among all settings or among settings significantly slower and more accurate than the step before",
        ),
        Column(
            "quicker",
            pa.bool_(),
            "whether the setting is significantly quicker than the run's own setting",
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
