"""The data that the page shows of each object: fixations, imprints and predicted classes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa

from visuohaptic.evaluation.summary import select
from visuohaptic.fixations.viewpoints import Camera, place_cameras
from visuohaptic.geometry.layouts import Layout
from visuohaptic.pictures.encoding import data_uri, picture_size, webp_address
from visuohaptic.pictures.imprint_scale import imprint_scale
from visuohaptic.pictures.model_figure import ModelFigure
from visuohaptic.pictures.object_pictures import MODEL
from visuohaptic.report.estimates import Row
from visuohaptic.report.run import Run
from visuohaptic.report.shown import OBJECTS_AT_MOST
from visuohaptic.report.wording import anchor_of, place_in_view, strategy_name
from visuohaptic.tables.phases import by_object, key_of, keys_of
from visuohaptic.tables.schema import readings
from visuohaptic.touches.touch_table import touch_outlines

PredictionCounts = Mapping[tuple[str, int], Counter[str]]
"""How often each class was predicted, by strategy and viewpoint."""


@dataclass(frozen=True)
class ViewPage:
    """One view of an object.

    Attributes
    ----------
    viewpoint : int
        The number of the viewpoint.
    azimuth, elevation : float
        The direction of the camera in degrees.
    rows, columns : int
        The size of the view in pixels.
    view, saliency, imprints : str
        Pictures as ``data:`` URIs; empty where there is none.
    marks : list of mappings
        The fixations in order: ``number``, ``column`` and ``row`` in pixels, ``place`` in words, and ``square``, the
        corners of the sensor in pixels.
    touches : list of mappings
        The touches: ``number``, ``size`` in object radii, contact ``state``, and ``near``, the share of the square that
        is nearly touched.
    distinct : int
        The number of distinct fixations.
    right : mapping of str to float
        The share of the view's tests that were correctly classified, by strategy.
    """

    viewpoint: int
    azimuth: float
    elevation: float
    rows: int
    columns: int
    view: str
    saliency: str
    imprints: str
    marks: list[Row]
    touches: list[Row]
    distinct: int
    right: Mapping[str, float]

    @property
    def path(self) -> str:
        """The fixations in order, as points of an SVG line."""
        return " ".join(f"{mark['column']:.1f},{mark['row']:.1f}" for mark in self.marks)


@dataclass(frozen=True)
class ObjectPage:
    """The data that the page shows of one object.

    Attributes
    ----------
    key, category, name : str
        The object, `class/name`, its class and its name.
    views : tuple of ViewPage
        All views.
    shown : ViewPage
        The view that is shown large.
    conspicuity : list of (str, str)
        Channel and conspicuity map of view `shown`, as a ``data:`` URI.
    skipped : list of (str, str)
        Channels that were skipped, and why.
    predicted : mapping
        By strategy, the share of the object's test sequences by predicted class.
    model_figure : ModelFigure or None
        The model with its touches, which a reader turns; None for an object without a mesh.
    """

    key: str
    category: str
    name: str
    views: tuple[ViewPage, ...]
    shown: ViewPage
    conspicuity: list[tuple[str, str]]
    skipped: list[tuple[str, str]]
    predicted: Mapping[str, Mapping[str, float]]
    model_figure: ModelFigure | None

    @property
    def anchor(self) -> str:
        """The object's anchor on the page."""
        return anchor_of(self.key)

    @property
    def mistaken(self) -> str | None:
        """The class that is predicted most often by the first strategy; None if the class is right or nothing was tested."""
        if not self.predicted:
            return None
        shares = next(iter(self.predicted.values()))
        most = max(shares, key=lambda name: (shares[name], name == self.category))
        return None if most == self.category else most

    @property
    def shown_rows(self) -> dict[str, str | int]:
        """Columns and values that select the fixations of view `shown` in a table."""
        return {
            "class": self.category,
            "object": self.name,
            "viewpoint": self.shown.viewpoint,
            "strategy": "fixation",
        }

    @property
    def right(self) -> dict[str, float]:
        """The share of the object's test sequences that were correctly classified, by strategy."""
        return {
            strategy: shares.get(self.category, 0.0) for strategy, shares in self.predicted.items()
        }


def choose_objects(run: Run) -> list[str]:
    """Return up to `OBJECTS_AT_MOST` objects with pictures, `class/name`, sorted.

    Objects that exceeded a tolerance are chosen first. The others are evenly spread over the sorted keys, so that
    classes keep their shares.
    """
    pictured = sorted(keys_of(run.pictures).to_pylist())
    if len(pictured) <= OBJECTS_AT_MOST:
        return pictured
    broken = {check.key for check in run.stability.broken} if run.stability is not None else set()
    chosen = [key for key in pictured if key in broken][:OBJECTS_AT_MOST]
    others = [key for key in pictured if key not in broken]
    indices = np.linspace(0, len(others) - 1, OBJECTS_AT_MOST - len(chosen)).round()
    return sorted([*chosen, *(others[index] for index in indices.astype(np.int64))])


def describe_objects(run: Run) -> list[ObjectPage]:
    """Return the pages of the objects of `choose_objects`, sorted by class and name."""
    cameras = place_cameras(run.parameters.viewpoints)
    scale = imprint_scale(run.parameters.sensor, run.parameters.scene)
    answers = _answers(run)
    pictures = {key_of(row): row for row in run.pictures.to_pylist()}
    tables = [
        (dict(by_object(table)), table.slice(0, 0))
        for table in (run.views, run.fixations, run.touches)
    ]
    return [
        _describe(
            pictures[key],
            [rows_of.get(key, empty) for rows_of, empty in tables],
            cameras,
            answers.get(key, {}),
            scale.sentence,
            run.parameters.sensor.taxels,
        )
        for key in choose_objects(run)
    ]


def most_varied(pages: Sequence[ObjectPage]) -> ObjectPage:
    """Return the object that explains the method: the squares of its shown view differ most in size.

    The number of different sizes, rounded to 0.01, decides; then the spread of their logarithms.
    """

    def variety(page: ObjectPage) -> tuple[int, float]:
        sizes = [note["size"] for note in page.shown.touches]
        spread = float(np.std(np.log(np.maximum(sizes, 1e-9)))) if sizes else -1.0
        return len({round(size, 2) for size in sizes}), spread

    return max(pages, key=variety)


def _describe(
    pictures: Row,
    tables: Sequence[pa.Table],
    cameras: Sequence[Camera],
    answers: PredictionCounts,
    imprint_words: str,
    layout: Layout,
) -> ObjectPage:
    seen, fixations, touches = tables
    rows = seen.drop_columns(["view", "saliency", "conspicuity"]).to_pylist()
    looked, fixated = (select(table, strategy="fixation") for table in (fixations, touches))
    stored = {name: dict(pictures[name]) for name in ("views", "saliency", "imprints")}
    views = tuple(
        _view_page(row, stored, looked, fixated, cameras, answers, layout) for row in rows
    )
    # An azimuth of 45 degrees shows front and side.
    shown = min(
        views, key=lambda view: (abs((view.azimuth - 45 + 180) % 360 - 180), view.viewpoint)
    )
    maps = select(seen, viewpoint=shown.viewpoint)["conspicuity"][0].as_py()
    return ObjectPage(
        key=key_of(pictures),
        category=pictures["class"],
        name=pictures["object"],
        views=views,
        shown=shown,
        conspicuity=[(channel, data_uri(png, "image/png")) for channel, png in maps],
        skipped=_skipped(rows),
        predicted=_predicted(answers),
        model_figure=_model_figure(pictures, touches, views, shown, imprint_words),
    )


def _model_figure(
    pictures: Row,
    touches: pa.Table,
    views: Sequence[ViewPage],
    shown: ViewPage,
    imprint_words: str,
) -> ModelFigure | None:
    if pictures["model"] is None:
        return None
    columns = ("strategy", "viewpoint", "touch", "contact_state")
    strategies = sorted(touches.column("strategy").unique().to_pylist())
    return ModelFigure(
        name=key_of(pictures),
        model={name: pictures[name] for name in MODEL},
        touch_keys=[
            (strategy, viewpoint, touch + 1, state)
            for strategy, viewpoint, touch, state in zip(
                *(touches.column(name).to_pylist() for name in columns), strict=True
            )
        ],
        sheets={strategy: webp_address(sheet) for strategy, sheet in pictures["sheets"]},
        strategies={strategy: strategy_name(strategy) for strategy in strategies},
        views=[(view.viewpoint, view.azimuth, view.elevation) for view in views],
        shown=shown.viewpoint,
        imprint_words=imprint_words,
    )


def _view_page(
    row: Row,
    pictures: Mapping[str, Mapping[int, bytes]],
    fixations: pa.Table,
    touches: pa.Table,
    cameras: Sequence[Camera],
    answers: PredictionCounts,
    layout: Layout,
) -> ViewPage:
    viewpoint = row["viewpoint"]
    felt, looked = (select(table, viewpoint=viewpoint) for table in (touches, fixations))
    is_near = readings(felt) > 0.9 if felt.num_rows else np.zeros((0, 1), dtype=bool)
    eye = np.array([row["eye_x"], row["eye_y"], row["eye_z"]], dtype=np.float64)
    stored = {name: by_viewpoint.get(viewpoint) for name, by_viewpoint in pictures.items()}
    height, width = picture_size(pictures["views"][viewpoint])
    squares = (
        cameras[viewpoint].project(touch_outlines(felt, layout), height).tolist()
        if viewpoint < len(cameras)
        else []
    )
    return ViewPage(
        viewpoint=viewpoint,
        azimuth=float(np.degrees(np.arctan2(eye[0], eye[2]))) % 360.0,
        elevation=float(np.degrees(np.arcsin(eye[1] / np.linalg.norm(eye)))),
        rows=height,
        columns=width,
        **{
            name if name != "views" else "view": webp_address(picture) if picture else ""
            for name, picture in stored.items()
        },
        marks=_marks(
            looked, dict(zip(felt["touch"].to_pylist(), squares, strict=False)), height, width
        ),
        touches=[
            {"number": touch + 1, "size": size, "state": state, "near": near}
            for touch, size, state, near in zip(
                *(felt[name].to_pylist() for name in ("touch", "sensor_size", "contact_state")),
                is_near.mean(axis=1).tolist(),
                strict=True,
            )
        ],
        distinct=row["distinct_fixations"],
        right={
            strategy: counts[row["class"]] / counts.total()
            for (strategy, number), counts in answers.items()
            if number == viewpoint
        },
    )


def _marks(fixations: pa.Table, outlines: Mapping[int, Any], height: int, width: int) -> list[Row]:
    """Return the middle of the pixel of each fixation that has one, and the outline of its touch, () without a touch."""
    rows = fixations.select(["touch", "pixel_row", "pixel_column"]).to_pylist()
    return [
        {
            "number": row["touch"] + 1,
            "column": row["pixel_column"] + 0.5,
            "row": row["pixel_row"] + 0.5,
            "place": place_in_view(
                row["pixel_row"] + 0.5, row["pixel_column"] + 0.5, height, width
            ),
            "square": outlines.get(row["touch"], ()),
        }
        for row in rows
        if row["pixel_row"] is not None and row["pixel_column"] is not None
    ]


def _answers(run: Run) -> dict[str, dict[tuple[str, int], Counter[str]]]:
    """Count the classes that the headline classifier predicted, by object, strategy and viewpoint."""
    answers: dict[str, dict[tuple[str, int], Counter[str]]] = {}
    if not run.pipelines:
        return answers
    table = run.pipelines[0]
    chosen = select(run.predictions, pipeline=table.name, classifier=table.headline.key)
    keys = ["class", "object", "strategy", "viewpoint", "predicted"]
    for row in chosen.group_by(keys).aggregate([([], "count_all")]).to_pylist():
        of_object = answers.setdefault(key_of(row), {})
        counts = of_object.setdefault((row["strategy"], row["viewpoint"]), Counter())
        counts[row["predicted"]] = row["count_all"]
    return answers


def _predicted(answers: PredictionCounts) -> dict[str, dict[str, float]]:
    sums: dict[str, Counter[str]] = {}
    for (strategy, _), counts in sorted(answers.items()):
        sums.setdefault(strategy, Counter()).update(counts)
    return {
        strategy: {name: count / counts.total() for name, count in sorted(counts.items())}
        for strategy, counts in sums.items()
    }


def _skipped(rows: Sequence[Row]) -> list[tuple[str, str]]:
    reasons = Counter((channel, reason) for row in rows for channel, reason in row["skipped"])
    return [
        (channel, reason if count == len(rows) else f"{reason} ({count} of {len(rows)} views)")
        for (channel, reason), count in sorted(reasons.items())
    ]
