"""What the page shows of each object: fixations, imprints and predicted classes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from visuohaptic.fixations.viewpoints import Camera, place_cameras
from visuohaptic.geometry.surface import read_surface
from visuohaptic.report.models import PackedModel, pack_model
from visuohaptic.report.pictures import (
    data_uri,
    imprint_sheet,
    imprint_strip,
    project,
    shrink_picture,
    square_corners,
)
from visuohaptic.report.run import Run
from visuohaptic.report.wording import anchor_of, listed, place_in_view, spaced
from visuohaptic.sensor.frames import row_axes
from visuohaptic.tables.phases import NORMAL_NAMES, POINT_NAMES, TANGENT_NAMES, key_of
from visuohaptic.tables.schema import images, matrix

Track = Callable[[Sequence[str]], Iterable[str]]
# How often each class was named, by strategy and viewpoint.
PredictionCounts = Mapping[tuple[str, int], Mapping[str, int]]
# A model for the page: fewer faces where many objects share the page.
_FACES_OF_ALL = 120_000
_FACES_AT_MOST = 4_000
_FACES_AT_LEAST = 1_200
OBJECTS_AT_MOST = 100
"""So many objects take 20 MB of the page with 16 views each."""
# A process of its own starts in the time that so many objects take.
_OBJECTS_WORTH_A_PROCESS = 8


@dataclass(frozen=True)
class TouchNote:
    """One touch in words: its number from 1, the square's edge in object radii, and the contact."""

    number: int
    size: float
    state: str
    penetration: float
    near: float


@dataclass(frozen=True)
class FixationMark:
    """Where a fixation lies in a view, in pixels, and the sensor's square around it."""

    number: int
    column: float
    row: float
    square: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class ViewPage:
    """One view of an object: pictures, fixations in order, and what was felt there."""

    viewpoint: int
    azimuth: float
    elevation: float
    rows: int
    columns: int
    view: str
    saliency: str
    marks: tuple[FixationMark, ...]
    imprints: str
    touches: tuple[TouchNote, ...]
    distinct: int
    right: Mapping[str, float]
    view_text: str
    saliency_text: str
    imprints_text: str

    @property
    def path(self) -> str:
        """The fixations in order, as points of an SVG line."""
        return " ".join(f"{mark.column:.1f},{mark.row:.1f}" for mark in self.marks)


@dataclass(frozen=True)
class ObjectPage:
    """All that the page shows of one object.

    Attributes
    ----------
    key, category, name, anchor : str
        What it is called, and where it stands on the page.
    views : tuple of ViewPage
        All its views, by viewpoint.
    shown : ViewPage
        The one that is shown large.
    conspicuity : tuple of (str, str)
        Channel and picture of each conspicuity map of the view shown.
    skipped : tuple of (str, str)
        Channels that did not run, in any view, each with the reason and where.
    named : mapping of str to mapping of str to float
        By strategy: the share of its test sequences that were named each class.
    strategies : tuple of str
        Strategies that touched it.
    median_size : mapping of str to float
        By strategy: median edge of the square, object radii.
    model : PackedModel or None
        None where the object's mesh is not at hand.
    touch_keys : tuple of (str, int, int, str)
        Strategy, viewpoint, number from 1 and contact state of each touch of the model.
    sheets : mapping of str to str
        By strategy: a picture of the imprints of the model's touches, a row a viewpoint and a
        column a touch.
    """

    key: str
    category: str
    name: str
    anchor: str
    views: tuple[ViewPage, ...]
    shown: ViewPage
    conspicuity: tuple[tuple[str, str], ...]
    skipped: tuple[tuple[str, str], ...]
    named: Mapping[str, Mapping[str, float]]
    strategies: tuple[str, ...]
    median_size: Mapping[str, float]
    model: PackedModel | None
    touch_keys: tuple[tuple[str, int, int, str], ...]
    sheets: Mapping[str, str]


def choose_objects(run: Run) -> list[str]:
    """Choose the objects that the page shows, `class/name`, sorted.

    All, up to `OBJECTS_AT_MOST`; of more than that those at which a tolerance was exceeded, and others
    evenly spread over all, so that classes keep their shares.
    """
    if len(run.objects) <= OBJECTS_AT_MOST:
        return run.objects
    broken = {check.key for check in run.stability.broken} if run.stability is not None else set()
    chosen = [key for key in run.objects if key in broken][:OBJECTS_AT_MOST]
    others = [key for key in run.objects if key not in broken]
    places = np.linspace(0, len(others) - 1, OBJECTS_AT_MOST - len(chosen)).round().astype(np.int64)
    return sorted([*chosen, *(others[place] for place in places)])


def describe_objects(run: Run, processes: int = 1, track: Track = iter) -> list[ObjectPage]:
    """Describe the objects of `choose_objects`, sorted by class and name.

    `track` takes the objects' names and gives them back one by one, as a progress bar does.
    """
    from joblib import Parallel, delayed

    cameras = place_cameras(run.parameters.viewpoints)
    answers = _answers(run)
    shown = choose_objects(run)
    tables = [_by_object(table, shown) for table in (run.views, run.fixations, run.touches)]
    faces = int(np.clip(_FACES_OF_ALL // len(shown), _FACES_AT_LEAST, _FACES_AT_MOST))

    def task(key: str) -> Any:
        parts = [table[key] for table in tables]
        mesh = run.meshes.get(key)
        return delayed(_describe)(key, mesh, parts, cameras, answers.get(key, {}), faces)

    # Thinning a model holds Python's lock, so threads would wait for each other.
    described = Parallel(
        n_jobs=min(processes, 1 + len(shown) // _OBJECTS_WORTH_A_PROCESS),
        return_as="generator",
    )(map(task, shown))
    return [next(described) for _ in track(shown)]


def choose_shown(views: Sequence[ViewPage]) -> ViewPage:
    """Choose the view that is shown large: the one nearest to 45 degrees, from which most is seen."""
    return min(
        views, key=lambda view: (abs((view.azimuth - 45.0 + 180.0) % 360.0 - 180.0), view.viewpoint)
    )


def most_varied(pages: Sequence[ObjectPage]) -> ObjectPage:
    """Choose the object that explains the method: its view shown has the most different squares."""
    return max(pages, key=lambda page: _variety([note.size for note in page.shown.touches]))


def _variety(sizes: Sequence[float]) -> tuple[int, float]:
    """Count the distinct sizes, rounded to 0.01, and measure their spread."""
    spread = float(np.std(np.log(np.maximum(sizes, 1e-9)))) if len(sizes) else -1.0
    return len({round(size, 2) for size in sizes}), spread


def _describe(
    key: str,
    mesh: Path | None,
    tables: Sequence[pa.Table],
    cameras: Sequence[Camera],
    answers: PredictionCounts,
    faces: int,
) -> ObjectPage:
    seen, fixations, touches = tables
    category, name = key.split("/", 1)
    rows = seen.to_pylist()
    views = tuple(_view_page(key, row, fixations, touches, cameras, answers) for row in rows)
    shown = choose_shown(views)
    row = next(row for row in rows if row["viewpoint"] == shown.viewpoint)
    model, touch_keys = _model(mesh, touches, faces)
    strategies = sorted(set(touches.column("strategy").to_pylist()))
    return ObjectPage(
        key=key,
        category=category,
        name=name,
        anchor=anchor_of(key),
        views=views,
        shown=shown,
        conspicuity=tuple(
            (channel, data_uri(png, "image/png")) for channel, png in row["conspicuity"]
        ),
        skipped=_skipped(rows),
        named=_named(answers),
        strategies=tuple(strategies),
        median_size={strategy: _median_size(touches, strategy) for strategy in strategies},
        model=model,
        touch_keys=touch_keys,
        sheets={strategy: _sheet(touches, strategy) for strategy in strategies} if model else {},
    )


def _view_page(
    key: str,
    row: Mapping[str, Any],
    fixations: pa.Table,
    touches: pa.Table,
    cameras: Sequence[Camera],
    answers: PredictionCounts,
) -> ViewPage:
    viewpoint = row["viewpoint"]
    view, (height, width) = shrink_picture(row["view"])
    saliency, _ = shrink_picture(row["saliency"], factor=2)
    felt = _of_view(touches, viewpoint)
    camera = cameras[viewpoint] if viewpoint < len(cameras) else None
    marks = _marks(_of_view(fixations, viewpoint), felt, camera, height)
    imprints = images(felt) if felt.num_rows else np.zeros((0, 1, 1), dtype=np.float32)
    notes = _notes(felt, imprints)
    eye = np.array([row["eye_x"], row["eye_y"], row["eye_z"]], dtype=np.float64)
    azimuth = float(np.degrees(np.arctan2(eye[0], eye[2]))) % 360.0
    elevation = float(np.degrees(np.arcsin(eye[1] / np.linalg.norm(eye))))
    places = [place_in_view(mark.row, mark.column, height, width) for mark in marks]
    ordered = listed([f"{mark.number} {place}" for mark, place in zip(marks, places, strict=True)])
    return ViewPage(
        viewpoint=viewpoint,
        azimuth=azimuth,
        elevation=elevation,
        rows=height,
        columns=width,
        view=view,
        saliency=saliency,
        marks=marks,
        imprints=imprint_strip(imprints) if len(imprints) else "",
        touches=notes,
        distinct=row["distinct_fixations"],
        right=_right(key, viewpoint, answers),
        view_text=f"View {viewpoint} of {key}, seen from {azimuth:.0f} degrees around and "
        f"{elevation:.0f} degrees up, with fixations in order: {ordered or 'none'}.",
        saliency_text=f"Saliency map of view {viewpoint}, brightest at "
        f"{places[0] if places else 'no fixation'}, with the same fixations.",
        imprints_text=f"Imprints of view {viewpoint}: "
        + ("; ".join(_note_text(note) for note in notes) or "none")
        + ".",
    )


def _notes(felt: pa.Table, imprints: NDArray[np.float32]) -> tuple[TouchNote, ...]:
    near = (imprints > 0.9).mean(axis=(1, 2)) if len(imprints) else []
    rows = felt.select(["touch", "sensor_size", "contact_state", "penetration"]).to_pylist()
    return tuple(
        TouchNote(
            row["touch"] + 1, row["sensor_size"], row["contact_state"], row["penetration"], share
        )
        for row, share in zip(rows, map(float, near), strict=True)
    )


def _note_text(note: TouchNote) -> str:
    return f"{note.number} {spaced(note.state)}, size {note.size:.2f}"


def _marks(
    looked: pa.Table, felt: pa.Table, camera: Camera | None, resolution: int
) -> tuple[FixationMark, ...]:
    squares: dict[int, tuple[tuple[float, float], ...]] = {}
    if camera is not None and felt.num_rows:
        corners = _corners(felt)
        flat = project(camera, corners.reshape(-1, 3), resolution).reshape(-1, 4, 2)
        for touch, square in zip(felt.column("touch").to_pylist(), flat.tolist(), strict=True):
            squares[touch] = tuple((corner[0], corner[1]) for corner in square)
    rows = looked.select(["touch", "pixel_row", "pixel_column"]).to_pylist()
    return tuple(
        FixationMark(
            row["touch"] + 1,
            row["pixel_column"] + 0.5,
            row["pixel_row"] + 0.5,
            squares.get(row["touch"], ()),
        )
        for row in rows
        if row["pixel_row"] is not None and row["pixel_column"] is not None
    )


def _corners(touches: pa.Table) -> NDArray[np.float64]:
    columns = matrix(touches, TANGENT_NAMES)
    rows = row_axes(matrix(touches, NORMAL_NAMES), columns)
    sizes = touches.column("sensor_size").to_numpy()
    return square_corners(matrix(touches, POINT_NAMES), columns, rows, sizes)


def _model(
    mesh: Path | None, touches: pa.Table, faces: int
) -> tuple[PackedModel | None, tuple[tuple[str, int, int, str], ...]]:
    if mesh is None:
        return None, ()
    names = (*POINT_NAMES, *NORMAL_NAMES, *TANGENT_NAMES, "sensor_size")
    keys = touches.select(["strategy", "viewpoint", "touch", "contact_state"]).to_pylist()
    return pack_model(read_surface(mesh), matrix(touches, names), faces), tuple(
        (row["strategy"], row["viewpoint"], row["touch"] + 1, row["contact_state"]) for row in keys
    )


def _sheet(touches: pa.Table, strategy: str) -> str:
    own = touches.filter(pc.equal(touches.column("strategy"), strategy))
    viewpoints, numbers = (own.column(name).to_numpy() for name in ("viewpoint", "touch"))
    return imprint_sheet(images(own), viewpoints.astype(np.int64), numbers.astype(np.int64))


def _by_object(table: pa.Table, objects: Sequence[str]) -> dict[str, pa.Table]:
    owners = pc.binary_join_element_wise(table.column("class"), table.column("object"), "/")
    return {key: table.filter(pc.equal(owners, key)) for key in objects}


def _of_view(table: pa.Table, viewpoint: int) -> pa.Table:
    chosen = pc.and_(
        pc.equal(table.column("viewpoint"), viewpoint),
        pc.equal(table.column("strategy"), "fixation"),
    )
    return table.filter(chosen)


def _answers(run: Run) -> dict[str, dict[tuple[str, int], dict[str, int]]]:
    """Count what the best classifier named each object."""
    if not run.pipelines:
        return {}
    table = run.pipelines[0]
    chosen = pc.and_(
        pc.equal(run.predictions.column("pipeline"), table.name),
        pc.equal(run.predictions.column("classifier"), table.best.key),
    )
    keys = ["class", "object", "strategy", "viewpoint", "predicted"]
    counts = run.predictions.filter(chosen).group_by(keys).aggregate([([], "count_all")])
    found: dict[str, dict[tuple[str, int], dict[str, int]]] = {}
    for row in counts.to_pylist():
        of_object = found.setdefault(key_of(row), {})
        of_view = of_object.setdefault((row["strategy"], row["viewpoint"]), {})
        of_view[row["predicted"]] = row["count_all"]
    return found


def _named(answers: PredictionCounts) -> dict[str, dict[str, float]]:
    sums: dict[str, dict[str, int]] = {}
    for (strategy, _), counts in answers.items():
        held = sums.setdefault(strategy, {})
        for name, count in counts.items():
            held[name] = held.get(name, 0) + count
    return {
        strategy: {name: count / sum(counts.values()) for name, count in sorted(counts.items())}
        for strategy, counts in sorted(sums.items())
    }


def _right(key: str, viewpoint: int, answers: PredictionCounts) -> dict[str, float]:
    category = key.split("/", 1)[0]
    return {
        strategy: counts.get(category, 0) / sum(counts.values())
        for (strategy, number), counts in answers.items()
        if number == viewpoint
    }


def _skipped(rows: Sequence[Mapping[str, Any]]) -> tuple[tuple[str, str], ...]:
    reasons: dict[tuple[str, str], int] = {}
    for row in rows:
        for channel, reason in row["skipped"]:
            reasons[channel, reason] = reasons.get((channel, reason), 0) + 1
    return tuple(
        (channel, reason if count == len(rows) else f"{reason} ({count} of {len(rows)} views)")
        for (channel, reason), count in sorted(reasons.items())
    )


def _median_size(touches: pa.Table, strategy: str) -> float:
    of_strategy = touches.filter(pc.equal(touches.column("strategy"), strategy))
    return float(np.median(of_strategy.column("sensor_size").to_numpy()))
