"""The tables that the phases make, in the order of the flow."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from visuohaptic.tables.schema import COUNT, REAL, TEXT, Column, Schema, count, names_of, share

OBJECT_KEYS = (
    Column("class", TEXT, "class of the object"),
    Column("object", TEXT, "name of the object within its class"),
)


def key_of(row: Mapping[str, str]) -> str:
    """Return an object's `class/name` from a row of a table."""
    return f"{row['class']}/{row['object']}"


def keys_of(table: pa.Table) -> pa.ChunkedArray:
    """Return the `class/name` of each row's object."""
    return pc.binary_join_element_wise(table.column("class"), table.column("object"), "/")


def by_object(table: pa.Table) -> Iterator[tuple[str, pa.Table]]:
    """Yield each object, `class/name`, and its rows, of a table that is sorted by its keys."""
    names = np.array(keys_of(table).to_pylist(), dtype=object)
    starts = [0, *(np.flatnonzero(names[1:] != names[:-1]) + 1), len(names)]
    for start, end in itertools.pairwise(starts if len(names) else []):
        yield names[start], table.slice(start, end - start).combine_chunks()


def of_objects(table: pa.Table, objects: Collection[str] | None) -> pa.Table:
    """Return the rows of some objects, given as `class/name`; None returns all rows."""
    if objects is None:
        return table
    chosen = pc.is_in(keys_of(table), pa.array(list(objects), pa.string()))
    return table.filter(chosen).combine_chunks()


def owner_columns(key: str) -> dict[str, object]:
    """Return the columns that hold an object's `class/name`."""
    category, name = key.split("/")
    return {"class": category, "object": name}


def owners_of(table: pa.Table) -> list[tuple[str, str]]:
    """Return the object of each row as (class, name)."""
    return list(zip(table["class"].to_pylist(), table["object"].to_pylist(), strict=True))


VIEW_KEYS = (
    *OBJECT_KEYS,
    count("viewpoint", "index of the viewpoint, or of the random sequence"),
)

TOUCH_KEYS = (
    *VIEW_KEYS,
    Column("strategy", TEXT, "how the probing locations were chosen"),
    count("touch", "index in the sequence, from 0"),
)


def _vector(prefix: str, description: str, frame: str) -> tuple[Column, ...]:
    return tuple(
        Column(f"{prefix}{axis}", REAL, f"{description}, {axis}", frame, -1.0001, 1.0001)
        for axis in "xyz"
    )


POINT = _vector("", "probing location", "object frame, unit sphere")
NORMAL = _vector("normal_", "outward unit normal", "object frame")
TANGENT = _vector("tangent_", "the imprint's +column axis", "object frame")
POINT_NAMES, NORMAL_NAMES, TANGENT_NAMES = map(names_of, (POINT, NORMAL, TANGENT))

SENSOR_SIZE = Column("sensor_size", REAL, "edge of the sensor's square", "object radii", 0)

CONTACT_STATES = ("full", "shrunk", "at_minimum", "blocked", "partial")
"""States of the sensor's contact."""

OUT_OF_REACH = ("at_minimum", "blocked")
"""Contact states of locations that a sensor of adaptive size can't reach."""

CONTACT_STATE = Column("contact_state", TEXT, "full, shrunk, at_minimum, blocked or partial")

VIEWS = Schema(
    "views",
    VIEW_KEYS,
    (
        *(Column(f"eye_{axis}", REAL, f"camera centre, {axis}", "object frame") for axis in "xyz"),
        Column("view", pa.binary(), "the rendered view, PNG"),
        Column(
            "saliency", pa.binary(), "the saliency map, 8-bit grey PNG; white is the view's maximum"
        ),
        Column(
            "conspicuity", pa.map_(TEXT, pa.binary()), "conspicuity map of each channel that ran"
        ),
        Column("skipped", pa.map_(TEXT, TEXT), "reason for each channel that did not run"),
        count("distinct_fixations", "fixations before the view was exhausted"),
    ),
)

SPARE = 16
"""Additional probing locations, which replace locations that the sensor can't reach."""

FIXATIONS = Schema(
    "fixations",
    TOUCH_KEYS,
    (
        Column("pixel_row", COUNT, "row in the view, 0 at the top", "pixel", 0, nullable=True),
        Column(
            "pixel_column", COUNT, "column in the view, 0 at the left", "pixel", 0, nullable=True
        ),
        *POINT,
        *NORMAL,
        count("face", "triangle of the object's mesh"),
        Column(
            "saliency",
            REAL,
            "saliency at the fixation",
            "of the view's maximum",
            0,
            1,
            nullable=True,
        ),
        Column(
            "unreachable",
            TEXT,
            "replace, skip or keep a location that the sensor can't reach; missing: as probing.unreachable says",
            nullable=True,
        ),
        Column("random_stream", TEXT, "name of the strategy's stream of random numbers"),
    ),
)

POLICY_FIXATIONS = replace(FIXATIONS, name="policy_fixations")
"""Locations that policies chose, one row per try, in reach or not; readers join them with `FIXATIONS`."""

TOUCHES = Schema(
    "touches",
    TOUCH_KEYS,
    (
        Column(
            "image",
            pa.list_(pa.float32()),
            "tactile imprint, row by row",
            "1 nearest point, 0 farthest; absolute scale: 1 contact, 0 out of the depth range",
            0,
            1,
        ),
        SENSOR_SIZE,
        CONTACT_STATE,
        Column("penetration", REAL, "deepest penetration left", "object radii", 0),
        count(
            "rank",
            "index among the view's probing locations, from 0; larger than touch if locations before "
            "are out of reach",
        ),
        *POINT,
        *NORMAL,
        *TANGENT,
    ),
)

EFFECTS = Schema(
    "effects",
    (
        *OBJECT_KEYS,
        count("first_viewpoint", "first viewpoint of the job"),
        Column("effect", TEXT, "name of the effect"),
    ),
    (
        Column(
            "scene", TEXT, "preset of the scene, or any: effects of the view, which no preset sets"
        ),
        Column("mode", TEXT, "auto, always or never"),
        Column("reason", TEXT, "why the effect was needed, or why not"),
        count("touches", "touches of the job; views, for effects of the view"),
        count("needed", "touches or views that needed the effect"),
        count("runs", "touches or views with the effect simulated"),
        Column(
            "seconds", REAL, "time spent on the effect; differs between runs", "s of processor", 0
        ),
    ),
)

CONTOURLET_FEATURES = tuple(f"contourlet_{band:02d}" for band in range(1, 17))

IMPRINT_FEATURES = {
    "imprint_mean": "mean of the imprint",
    "imprint_deviation": "standard deviation of the imprint",
    "imprint_skewness": "skewness of the imprint",
    "imprint_empty": "share of sensing points out of reach",
    "imprint_contact": "share of sensing points in contact",
    "imprint_bending": "sum of the second derivatives of the fitted quadric",
    "imprint_saddle": "difference of the principal second derivatives",
    "imprint_upright_bending": "difference of the second derivatives along columns and rows",
    "imprint_tilt_columns": "size of the slope along the columns",
    "imprint_tilt_rows": "size of the slope along the rows",
    "imprint_roughness": "standard deviation of the residual of the fitted quadric",
    "imprint_step_columns": "mean step between neighbours along the columns",
    "imprint_step_rows": "mean step between neighbours along the rows",
}

KINESTHETIC_FEATURES = (*POINT_NAMES, *NORMAL_NAMES)

FEATURES = Schema(
    "features",
    TOUCH_KEYS,
    (
        *(
            Column(name, REAL, "standard deviation of one directional sub-band")
            for name in CONTOURLET_FEATURES
        ),
        *POINT,
        *NORMAL,
        SENSOR_SIZE,
        CONTACT_STATE,
        *(Column(name, REAL, description) for name, description in IMPRINT_FEATURES.items()),
    ),
)

CELL_KEYS = (
    Column("pipeline", TEXT, "how features become an answer"),
    Column("strategy", TEXT, "how the probing locations were chosen"),
    Column("classifier", TEXT, "the classifier"),
)

SCORE_KEYS = (
    *CELL_KEYS,
    count("split", "index of the train and test split"),
    count("seed", "index of the repeat with another random seed of training"),
)

SCORES = Schema(
    "scores",
    SCORE_KEYS,
    (
        share("accuracy", "share of test sequences correctly classified"),
        share("object_accuracy", "share of test objects correctly classified by vote"),
        count("sequences", "test sequences", 1),
        Column(
            "note",
            TEXT,
            "remark of the classifier, such as a regularised covariance",
            nullable=True,
        ),
    ),
)

PREDICTIONS = Schema(
    "predictions",
    (*SCORE_KEYS, *VIEW_KEYS),
    (
        Column("predicted", TEXT, "the class that the classifier predicted"),
        Column(
            "probability",
            REAL,
            "probability of that class from the classifier, before temperature scaling",
            "1",
            0,
            1.0001,
            nullable=True,
        ),
        Column(
            "voted",
            TEXT,
            "class with most votes of the object's sequences",
            nullable=True,
        ),
    ),
)

PHASES = (VIEWS, FIXATIONS, POLICY_FIXATIONS, TOUCHES, EFFECTS, FEATURES, SCORES, PREDICTIONS)
