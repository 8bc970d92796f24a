"""Draw the pictures of the pages that explain: `python docs/make_drawings.py`, or only some by their names."""

from __future__ import annotations

import io
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gymnasium
import matplotlib.pyplot as plt
import numpy as np
import pyarrow.compute as pc
import pyarrow.parquet
import trimesh
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Polygon
from PIL import Image

import visuohaptic as vh
from turned.leads import read_kept_leads
from visuohaptic.active import seek_relief
from visuohaptic.attention import attend
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.evaluation.held_out import summarise_evaluation
from visuohaptic.evaluation.intervals import object_interval
from visuohaptic.fixations.places import is_visible
from visuohaptic.fixations.rendering import Views, render_views
from visuohaptic.fixations.viewpoints import Camera, place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.recognition import make_order_free, touch_descriptors
from visuohaptic.recognition.classifiers import CLASSIFIERS
from visuohaptic.recognition.encoding import SequenceEncoder
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.wording import points
from visuohaptic.tables.phases import CONTOURLET_FEATURES, NORMAL_NAMES, POINT_NAMES
from visuohaptic.tables.schema import matrix, read_table
from visuohaptic.tables.studies import EVALUATION
from visuohaptic.touches.touch_table import touch_outlines

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "pictures"
DEFAULT_RUN = ROOT / "tests" / "golden" / "kept" / "default_run"
PARAMETERS = ExperimentParameters()
WIDTH = 7.0
"""Width of a figure (inches): 700 pixels at 100 dots per inch."""

DOTS = 160
LARGEST_BYTES = 150_000
INK, BLUE, ORANGE, YELLOW, GREY = "#1e2228", "#0b57a4", "#c2570c", "#ffd600", "#9aa0a6"

STYLE = {
    "font.size": 7.5,
    "axes.titlesize": 8,
    "axes.edgecolor": INK,
    "text.color": INK,
    "axes.labelcolor": INK,
    "figure.facecolor": "white",
}


# One view of an object -------------------------------------------------------------------------------------------


def see(surface: Surface, camera: Camera, attention: AttentionParameters) -> tuple[Views, Any]:
    """Render one view, and compute its saliency map and fixations."""
    views = render_views(
        RayCaster(surface), [camera], PARAMETERS.rendering, PARAMETERS.scene.effects
    )
    [attended] = attend(**views.attend_arguments(), parameters=attention)
    return views, attended


def window(masks: Sequence[np.ndarray], margin: int) -> tuple[slice, slice]:
    """Return the rows and columns that show the object in all masks, with a margin (pixels)."""
    rows, columns = np.nonzero(np.any(masks, axis=0))
    return (
        slice(max(rows.min() - margin, 0), rows.max() + margin + 1),
        slice(max(columns.min() - margin, 0), columns.max() + margin + 1),
    )


def show_image(axes: Axes, image: np.ndarray, title: str = "", **how: Any) -> None:
    """Show an image without ticks."""
    axes.imshow(image, **how)
    axes.set_title(title, pad=3)
    axes.set_xticks([])
    axes.set_yticks([])


def whitened(views: Views) -> np.ndarray:
    """Return the colours of the first view on a white background."""
    return np.where(views.mask[0][..., None], views.colour[0], 1.0)


def number(axes: Axes, column: float, row: float, text: str, *, seen: bool = True) -> None:
    """Mark a place with a number: filled if the viewpoint sees it."""
    face = YELLOW if seen else "white"
    box = {"boxstyle": "circle,pad=0.16", "fc": face, "ec": INK, "lw": 0.7}
    if not seen:
        box |= {"ls": (0, (2, 1.2))}
    axes.text(column, row, text, ha="center", va="center", size=6, bbox=box, zorder=9)


def outline(axes: Axes, mask: np.ndarray, **how: Any) -> None:
    """Draw the outline of a mask."""
    axes.contour(mask.astype(float), [0.5], **how)


# Attention -------------------------------------------------------------------------------------------------------


def draw_attention() -> Figure:
    """Draw a view, its conspicuity maps, its saliency map, and the five fixations with inhibition of return."""
    surface = vh.example("car").surface
    attention = PARAMETERS.attention
    views, seen = see(surface, place_cameras(PARAMETERS.viewpoints)[2], attention)
    mask = views.mask[0]
    rows, columns = window([mask], 4)
    height = (rows.stop - rows.start) / (columns.stop - columns.start)
    figure, axes = plt.subplots(
        3, 4, figsize=(WIDTH, 3 * (WIDTH / 4 * height + 0.22)), layout="constrained"
    )
    cut = (rows, columns)
    drawn = axes.reshape(-1)
    show_image(drawn[0], whitened(views)[cut], "view")
    maps = {name: seen.conspicuity[name] for name in seen.conspicuity}
    largest = max(float(plane.max()) for plane in maps.values())
    for place, (name, plane) in zip(drawn[1:], maps.items(), strict=False):
        shown = np.ma.masked_where(~mask, plane)[cut]
        show_image(place, shown, f"conspicuity: {name}", cmap="viridis", vmin=0, vmax=largest)
    saliency = np.ma.masked_where(~mask, seen.saliency)[cut]
    show_image(drawn[6], saliency, "saliency: the sum of the five", cmap="viridis", vmin=0, vmax=1)
    drive, path = seen.saliency.copy(), seen.scanpath
    places = list(zip(path.columns - columns.start, path.rows - rows.start, strict=True))
    for step in range(4):
        panel = drawn[7 + step]
        shown = np.ma.masked_where(~mask, drive)[cut]
        words = "fixation 1" if step == 0 else f"fixation {step + 1}: {step} inhibited"
        show_image(panel, shown, words, cmap="viridis", vmin=0, vmax=drive.max())
        away = np.linalg.norm(views.point[0] - path.points[step], axis=-1) / attention.focus_radius
        rim = np.clip((away - 1) / attention.inhibition_falloff, 0, 1)
        focus = (mask & (away <= 1))[cut]
        outline(panel, focus, colors="white", linewidths=1.6)
        outline(panel, focus, colors=INK, linewidths=0.8, linestyles="--")
        number(panel, *places[step], str(step + 1))
        drive = drive * rim * rim * (3 - 2 * rim)
    show_image(drawn[11], whitened(views)[cut], "five fixations, in order")
    drawn[11].plot(*zip(*places, strict=True), color="white", lw=1.5)
    drawn[11].plot(*zip(*places, strict=True), color=INK, lw=0.7)
    for step, place in enumerate(places):
        number(drawn[11], *place, str(step + 1))
    for place in drawn:
        for spine in place.spines.values():
            spine.set_visible(False)
    return figure


# Sensor ----------------------------------------------------------------------------------------------------------


def section_of(surface: Surface, normal: Sequence[float]) -> list[np.ndarray]:
    """Return the lines (k, 3) in which a plane through the origin cuts a surface."""
    mesh = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
    path = mesh.section(plane_origin=[0, 0, 0], plane_normal=normal)
    return [np.asarray(path.vertices[entity.points]) for entity in path.entities]


def draw_section() -> Figure:
    """Draw the sensor on a bottle in section: approach, size, plane, gaps; and the imprint."""
    bottle = vh.example("bottle")
    absolute = {"sensor.normalisation": "absolute"}
    touched = bottle.touch(viewpoints=1, parameters=absolute)
    row = touched.touches.to_pylist()[0]
    point = np.array([row[name] for name in POINT_NAMES])
    normal = np.array([row[name] for name in NORMAL_NAMES])
    size, deep = row["sensor_size"], PARAMETERS.sensor.depth_range
    lines = section_of(bottle.surface, [1, 0, 0])
    figure = plt.figure(figsize=(WIDTH, 2.6), layout="constrained")
    left, middle, right = figure.subplots(1, 3, width_ratios=[0.75, 1.75, 0.95])
    up = np.array([0.0, normal[2], -normal[1]])
    for place in (left, middle):
        for line in lines:
            place.fill(line[:, 2], line[:, 1], color="#d9dde2", zorder=1)
            place.plot(line[:, 2], line[:, 1], color=INK, lw=0.8, zorder=2)
        place.set_aspect("equal")
        place.set_xlabel("z (object radii)")

    def across(place: Axes, edge: float, deep: float, **how: Any) -> None:
        """Draw a line of the sensor's width, some depth below its plane."""
        ends = [point - deep * normal + side * edge / 2 * up for side in (-1, 1)]
        place.plot([end[2] for end in ends], [end[1] for end in ends], **how)

    across(left, size, 0, color=BLUE, lw=2, zorder=4)
    start = point + 0.55 * normal
    arrow = {"arrowstyle": "->", "color": BLUE, "lw": 1.2}
    left.annotate("", point[[2, 1]], start[[2, 1]], arrowprops=arrow)
    left.text(0.42, 0.72, "approach\nalong the\nnormal", color=BLUE, size=7, va="top")
    left.set_xlim(-0.45, 0.95)
    left.set_ylim(-0.72, 1.05)
    left.set_ylabel("y (object radii)")
    left.set_title("a bottle, cut in two")
    across(middle, PARAMETERS.sensor.largest_size, 0, color=ORANGE, lw=1.4, ls=(0, (4, 2)))
    across(middle, size, 0, color=BLUE, lw=2.4, zorder=5)
    across(middle, size, deep, color=BLUE, lw=0.9, ls=":", zorder=4)
    sensing = PARAMETERS.sensor.resolution
    steps = (np.arange(sensing) + 0.5) / sensing - 0.5
    felt = vh.press(bottle.surface, [point], [normal], size=size, resolution=sensing, depth=deep)
    gaps = np.minimum(-felt.heights[0][:, sensing // 2], deep)
    for gap, step in zip(gaps, -steps, strict=True):
        taxel = point + step * size * up
        end = taxel - gap * normal
        middle.plot([taxel[2], end[2]], [taxel[1], end[1]], color=BLUE, lw=0.7, zorder=4)
    middle.set_xlim(point[2] - 0.18, point[2] + 0.29)
    middle.set_ylim(point[1] - 0.2, point[1] + 0.17)
    for right_by, up_by, words, colour in (
        (0.012, 0.125, "largest square, 0.30: its\nlower end would be inside", ORANGE),
        (0.012, 0.03, f"the sensor, shrunk to {size:.2f};\ncontact reads 1", BLUE),
        (0.012, -0.058, "gaps to neck and shoulder:\nread between 1 and 0", BLUE),
        (-0.165, -0.125, f"{deep:g} below the\nplane: reads 0", BLUE),
    ):
        spot = (point[2] + right_by, point[1] + up_by)
        middle.text(*spot, words, color=colour, size=7, va="center")
    middle.set_title("the plane of the sensor, and what its taxels read")
    show_image(right, touched.imprints[0], "the imprint", cmap="gray", vmin=0, vmax=1)
    right.axvline(sensing // 2, color=BLUE, lw=1)
    right.set_xlabel("line: the cut\nwhite 1: contact\nblack 0: gap of 0.1 or more", size=7)
    return figure


def draw_effects() -> Figure:
    """Draw the imprints of one place: ideal, with each effect of a worn array added in turn, and of a new array."""
    bottle = vh.example("bottle")
    base = {"sensor.normalisation": "absolute"}
    scenes: list[tuple[str, dict[str, Any]]] = [("ideal: gaps", {"scene.preset": "ideal"})]
    added: list[str] = []
    words = {
        "elastic_cover": "+ elastic cover",
        "force_response": "+ force response",
        "gain_scatter": "+ gain scatter",
        "hysteresis": "+ hysteresis",
        "drift": "+ drift",
        "dead_cells": "+ dead cells",
        "crosstalk": "+ crosstalk",
        "noise": "+ noise",
        "quantisation": "+ 8 bits: worn_fsr",
    }
    for name, title in words.items():
        added.append(name)
        off = {f"scene.effects.{other}": "never" for other in words if other not in added}
        scenes.append((title, {"scene.preset": "worn_fsr", **off}))
    scenes.append(("fsr400: a new array", {"scene.preset": "fsr400"}))
    figure, axes = plt.subplots(2, 6, figsize=(WIDTH, 2.95), layout="constrained")
    before = None
    for place, (title, values) in zip(axes.reshape(-1), scenes, strict=False):
        touched = bottle.touch(viewpoints=1, parameters={**base, **values})
        image = touched.imprints[0]
        show_image(place, image, "", cmap="gray", vmin=0, vmax=1)
        place.set_title(title, size=7.5, pad=3)
        note = "1: contact"
        if before is not None and title.startswith("+ ") and title != "+ elastic cover":
            note = f"changes ≤ {abs(image - before).max():.2g}"
        if title in ("+ elastic cover", "fsr400: a new array"):
            note = "1: 100 kPa or more"
        place.set_xlabel(note, size=7)
        before = image
    last = axes.reshape(-1)[-1]
    last.axis("off")
    last.text(0, 0.5, f"the touch of the\nsection: {row_size(touched):.2f} ×\n{row_size(touched):.2f} object radii", va="center", size=7)  # fmt: skip
    return figure


def row_size(touched: Any) -> float:
    """Return the edge of the sensor at the first touch, object radii."""
    return float(touched.touches.column("sensor_size")[0].as_py())


# Strategies ------------------------------------------------------------------------------------------------------

STRATEGIES = (
    "fixation",
    "curvature",
    "contour",
    "human",
    "seek_relief",
    "random",
    "random_anywhere",
    "random_visible",
    "random_walk",
    "farthest_point",
)
SHOWN = ("chair", 8, 1)
"""The example that shows strategies, viewpoints on its ring, and the viewpoint."""


def draw_strategies() -> Figure:
    """Draw the first five touches of one view by each strategy that a run can name."""
    name, count, viewpoint = SHOWN
    example = vh.example(name)
    ring = PARAMETERS.viewpoints.model_copy(update={"count": count})
    camera = place_cameras(ring)[viewpoint]
    views, _ = see(example.surface, camera, PARAMETERS.attention)
    caster, pixels = RayCaster(example.surface), views.mask.shape[1]
    rows, columns = window([views.mask[0]], 20)
    height = (rows.stop - rows.start) / (columns.stop - columns.start)
    figure, axes = plt.subplots(
        2, 5, figsize=(WIDTH, 2 * (WIDTH / 5 * height + 0.1)), layout="constrained"
    )
    for place, strategy in zip(axes.reshape(-1), STRATEGIES, strict=True):
        touched = example.touch(viewpoints=count, strategy=strategy).touches
        touched = touched.filter(pc.field("viewpoint") == viewpoint)
        points = matrix(touched, POINT_NAMES)
        seen = is_visible(caster, camera, points)
        show_image(place, whitened(views)[rows, columns], strategy)
        place.set_xlim(-0.5, columns.stop - columns.start - 0.5)
        place.set_ylim(rows.stop - rows.start - 0.5, -0.5)
        corners = camera.project(touch_outlines(touched, PARAMETERS.sensor.taxels), pixels)
        corners = corners - [columns.start, rows.start]
        for square in corners[seen]:
            place.add_patch(Polygon(square, fill=False, ec=INK, lw=0.8))
        spots = camera.project(points, pixels) - [columns.start, rows.start]
        for index in reversed(range(len(spots))):
            number(place, *spots[index], str(index + 1), seen=bool(seen[index]))
        for spine in place.spines.values():
            spine.set_visible(False)
    return figure


# A policy --------------------------------------------------------------------------------------------------------


def draw_policy() -> Figure:
    """Draw how `seek_relief` chooses: places with their scores after each touch, the choice, and its imprint."""
    name, count, viewpoint = SHOWN
    example = vh.example(name)
    ring = PARAMETERS.viewpoints.model_copy(update={"count": count})
    camera = place_cameras(ring)[viewpoint]
    offered: list[np.ndarray] = []
    felt: list[list[Any]] = []

    def next_location(view: Any, touches: Sequence[Any]) -> np.ndarray | None:
        if np.allclose(view.camera.eye, camera.eye):
            offered.append(view.places.points)
            felt.append(list(touches))
        return seek_relief.next_location(view, touches)

    vh.register(vh.Policy("shown", "seek_relief, watched", next_location))
    touched = example.touch(viewpoints=count, strategy="shown")
    views, _ = see(example.surface, camera, PARAMETERS.attention)
    pixels = views.mask.shape[1]
    rows, columns = window([views.mask[0]], 6)
    mine = touched.touches.filter(pc.field("viewpoint") == viewpoint)
    points = matrix(mine, POINT_NAMES)
    imprints = touched.imprints[np.asarray(touched.touches.column("viewpoint")) == viewpoint]
    figure = plt.figure(figsize=(WIDTH, 3.0), layout="constrained")
    above = figure.subplots(2, 4, height_ratios=[3.2, 1])
    for step in range(4):
        place, below = above[:, step]
        shown = 0.65 + 0.35 * whitened(views)
        show_image(place, shown[rows, columns], f"touch {step + 1}")
        tries = [one for one in felt[step] if one.imprint is not None]
        spots = camera.project(offered[step], pixels) - [columns.start, rows.start]
        if tries:
            away = offered[step][:, None] - np.stack([one.point for one in tries])
            relief = np.array([float(one.imprint.std(dtype=np.float64)) for one in tries])
            scores = seek_relief.acquisition(np.einsum("pnd,pnd->pn", away, away), relief)
            place.scatter(*spots.T, c=scores, cmap="viridis", s=5, lw=0, zorder=3)
        else:
            place.scatter(*spots.T, c=GREY, s=5, lw=0, zorder=3)
        marks = camera.project(points, pixels) - [columns.start, rows.start]
        for index in range(step + 1):
            number(place, *marks[index], str(index + 1))
        show_image(below, imprints[step], cmap="gray", vmin=0, vmax=1)
        below.set_xlabel(f"relief {imprints[step].std():.2f}", size=7)
        for spine in place.spines.values():
            spine.set_visible(False)
    return figure


# The environment -------------------------------------------------------------------------------------------------


def draw_environment() -> Figure:
    """Draw what an agent of `visuohaptic/Touch-v0` observes after three random touches."""
    import visuohaptic.environment  # noqa: F401 - registers the name

    rows = gymnasium.make_vec("visuohaptic/Touch-v0", num_envs=1, touches=5)
    seen, told = rows.reset(seed=3)
    generator, tried = np.random.default_rng(0), []
    for _ in range(3):
        place = generator.choice(np.flatnonzero(seen["valid"][0, :-1]))
        tried.append(place)
        action = {"action": np.array([place]), "prediction": np.zeros((1, 4))}
        seen, *_ = rows.step(action)
    view, saliency, places = seen["view"][0], seen["saliency"][0, ..., 0], seen["places"][0]
    camera = place_cameras(PARAMETERS.viewpoints)[int(told["viewpoint"][0])]
    spots = camera.project(places[:, :3].astype(np.float64), len(view))
    mask = (view != view[0, 0]).any(axis=-1)
    rows_cut, columns_cut = window([mask], 10)
    spots = spots - [columns_cut.start, rows_cut.start]
    valid = seen["valid"][0, :-1] == 1
    figure, axes = plt.subplots(1, 3, figsize=(WIDTH, 2.5), layout="constrained")
    shown = np.where(mask[..., None], 0.65 * 255 + 0.35 * view, 255).astype(np.uint8)
    show_image(axes[0], shown[rows_cut, columns_cut], "view, places and valid")
    axes[0].scatter(*spots[valid].T, s=9, color=BLUE, lw=0, label="valid")
    axes[0].scatter(
        *spots[~valid].T, s=9, fc="white", ec=INK, lw=0.7, label="out of reach, or tried"
    )
    for index, place in enumerate(tried):
        number(axes[0], *spots[place], str(index + 1))
    axes[0].legend(loc="lower center", bbox_to_anchor=(0.5, -0.16), ncols=2, frameon=False, fontsize=7, handletextpad=0.1)  # fmt: skip
    map_shown = np.ma.masked_where(~mask, saliency)[rows_cut, columns_cut]
    show_image(axes[1], map_shown, "saliency and fixations", cmap="viridis", vmin=0)
    right, up = seen["fixations"][0, :5].T
    half = len(view) / 2
    marks = np.stack([half * (1 + right) - columns_cut.start, half * (1 - up) - rows_cut.start], 1)
    for index, mark in enumerate(marks):
        number(axes[1], *mark, str(index + 1))
    show_image(axes[2], seen["imprint"][0], "imprint of touch 3", cmap="gray", vmin=0, vmax=1)
    position = ", ".join(f"{value:.2f}" for value in seen["pose"][0, :3])
    words = f"size {seen['size'][0]:.2f}, contact {seen['contact'][0]},\npose ({position}, …)"
    axes[2].set_xlabel(words, size=7)
    for place in axes[:2]:
        for spine in place.spines.values():
            spine.set_visible(False)
    rows.close()
    return figure


# Recognition -----------------------------------------------------------------------------------------------------

TESTED = ("chair", "sc_plastic_chair", 2)
"""Class, object and viewpoint that the picture of recognition shows."""

GROUPS = {
    "contourlet": 64,
    "imprint": 52,
    "sensor": 9,
    "pose": 64,
    "relations": 27,
    "embedding": 300,
}
"""Numbers of a sequence in pipeline `order_free`, by group (frame `full`)."""

SHADE: dict[str, Any] = {"cmap": "PuOr", "vmin": -2.5, "vmax": 2.5, "aspect": "auto"}
"""Colours of standardised numbers."""


@dataclass(frozen=True)
class Recognised:
    """The numbers on the way from five touches of one view to a class.

    Attributes
    ----------
    imprints : ndarray of shape (5, r, r)
        The imprints.
    features : ndarray of shape (5, 22)
        Bands, position and normal per touch, in standard deviations from the mean of the training touches.
    signals : ndarray of shape (5, 5)
        Outputs of the map per touch.
    sixty, descriptors : ndarray
        Scaled numbers of the sequence in pipelines `paper` (60,) and `order_free` (516,).
    classes : tuple of str
        The classes.
    scores, probabilities : ndarray of shape (c,)
        Scores of the support vector machine, and probabilities of the linear discriminant.
    """

    imprints: np.ndarray
    features: np.ndarray
    signals: np.ndarray
    sixty: np.ndarray
    descriptors: np.ndarray
    classes: tuple[str, ...]
    scores: np.ndarray
    probabilities: np.ndarray


def recognise_view() -> Recognised:
    """Train both pipelines on two objects per class, and classify a view of the third chair."""
    category, name, viewpoint = TESTED
    key = f"{category}/{name}"
    table = pyarrow.parquet.read_table(DEFAULT_RUN / "features.parquet")
    table = table.filter(pc.field("strategy") == "fixation")
    columns = [*CONTOURLET_FEATURES, *POINT_NAMES, *NORMAL_NAMES]
    rows, classes, objects = touch_descriptors(table)
    touches = matrix(table, columns).reshape(len(rows), 5, len(columns))
    others = sorted({one for one in objects if not one.startswith(f"{category}/")})
    tested = {one.split("/")[0]: one for one in reversed(others)}
    training = ~np.isin(objects, [key, *tested.values()])
    this = int(np.flatnonzero(np.asarray(objects) == key)[viewpoint])
    encoder = SequenceEncoder(PARAMETERS.recognition).fit(touches[training])
    machine = CLASSIFIERS["support_vector_machine"].make(PARAMETERS.recognition.classifier)
    machine.fit(encoder.transform(touches[training]), classes[training])
    ours = make_order_free().fit(rows[training], classes[training])
    view, described = touches[this : this + 1], rows[this : this + 1]
    every = touches[training].reshape(-1, len(columns))
    touched = vh.load(ROOT / "meshes" / "paper" / f"{key}.ply.gz", key=key).touch()
    chosen = np.asarray(touched.touches.column("viewpoint")) == viewpoint
    return Recognised(
        touched.imprints[chosen],
        (view[0] - every.mean(axis=0)) / every.std(axis=0),
        encoder.reduce(view)[0],
        encoder.transform(view)[0],
        ours[0].transform(described)[0],
        tuple(machine.classes_),
        machine.decision_function(encoder.transform(view))[0],
        ours.predict_proba(described)[0],
    )


def panel(figure: Figure, box: tuple[float, float, float, float], title: str = "") -> Axes:
    """Add axes without ticks: left, bottom, width and height in shares of the figure."""
    place = figure.add_axes(box)
    place.set_title(title, pad=3, size=7.5)
    place.set_xticks([])
    place.set_yticks([])
    return place


def arrow(figure: Figure, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Draw an arrow between two points, in shares of the figure."""
    how = {"arrowstyle": "-|>", "mutation_scale": 8, "color": INK, "lw": 0.9}
    figure.add_artist(FancyArrowPatch(start, end, transform=figure.transFigure, **how))


def draw_recognition() -> Figure:
    """Draw the two ways from five touches to a class, with the numbers of one view of a tested chair."""
    shown = recognise_view()
    figure = plt.figure(figsize=(WIDTH, 3.9))
    for index, imprint in enumerate(shown.imprints):
        box = (0.025, 0.765 - 0.15 * index, 0.077, 0.135)
        place = panel(figure, box, "" if index else "five imprints")
        place.imshow(imprint, cmap="gray", vmin=0, vmax=1)
        place.set_ylabel(str(index + 1), rotation=0, va="center", labelpad=5, size=7)
    place = panel(figure, (0.135, 0.165, 0.2, 0.735), "22 numbers per touch")
    place.imshow(shown.features, **SHADE)
    for edge in (15.5, 18.5):
        place.axvline(edge, color=INK, lw=0.8)
    for column, row, word in (
        (7.5, 4.62, "16 bands of\nthe imprint"),
        (17, 4.62, "x y z"),
        (20.5, 4.84, "normal"),
    ):
        place.text(column, row, word, ha="center", va="top", size=6.5)
    arrow(figure, (0.104, 0.53), (0.132, 0.53))
    arrow(figure, (0.338, 0.62), (0.375, 0.74))
    arrow(figure, (0.338, 0.42), (0.375, 0.27))
    _draw_paper(figure, shown)
    _draw_order_free(figure, shown)
    words = "colour: standard deviations from the training mean, violet +, orange −"
    figure.text(0.025, 0.03, words, size=6.5)
    return figure


def _draw_paper(figure: Figure, shown: Recognised) -> None:
    figure.text(0.375, 0.955, "pipeline paper", weight="bold", color=BLUE, size=8)
    place = panel(figure, (0.378, 0.60, 0.1, 0.28), "map: 5 signals")
    signals = shown.signals.T / np.ptp(shown.signals)
    for index, signal in enumerate(signals):
        place.plot(range(1, 6), signal - 1.15 * index, color=BLUE, marker="o", ms=1.8, lw=0.9)
    place.set_xlabel("touches 1 to 5", size=6.5, labelpad=2)
    arrow(figure, (0.482, 0.74), (0.51, 0.74))
    place = panel(figure, (0.535, 0.60, 0.19, 0.28), "5 × 12 = 60 numbers")
    place.imshow(shown.sixty.reshape(5, 12), **SHADE)
    for edge in (2.5, 5.5, 8.5):
        place.axvline(edge, color=INK, lw=0.8)
    place.set_xticks([1, 4, 7, 10], ["signal", "fine", "middle", "coarse"], size=6)
    place.tick_params(length=0, pad=2)
    place.set_xlabel("each: std, rms, skewness", size=6.5, labelpad=1)
    place.set_ylabel("5 signals", size=6.5, labelpad=2)
    arrow(figure, (0.728, 0.74), (0.785, 0.74))
    figure.text(0.757, 0.765, "SVM", ha="center", size=7)
    place = panel(figure, (0.845, 0.60, 0.135, 0.28), "score")
    bars(place, shown.classes, shown.scores, BLUE, "{:.1f}")


def _draw_order_free(figure: Figure, shown: Recognised) -> None:
    figure.text(0.375, 0.435, "pipeline order_free", weight="bold", color=ORANGE, size=8)
    words = "+ statistics of the imprint, size and state of the sensor"
    figure.text(0.558, 0.437, words, size=6.5)
    title = "516 numbers, free of the touches' order"
    place = panel(figure, (0.378, 0.165, 0.325, 0.2), title)
    place.imshow(shown.descriptors[None], **SHADE, interpolation="nearest")
    start = 0
    for word, count in GROUPS.items():
        if start:
            place.axvline(start - 0.5, color=INK, lw=0.8)
        short = {"relations": "pairs", "sensor": ""}.get(word, word)
        turn = 0 if count > 100 else 35
        place.text(start + count / 2, 0.56, short, ha="center", va="top", size=6, rotation=turn)
        start += count
    arrow(figure, (0.706, 0.265), (0.785, 0.265))
    figure.text(0.751, 0.285, "linear\ndiscriminant", ha="center", size=6.5)
    place = panel(figure, (0.845, 0.165, 0.135, 0.2), "probability")
    bars(place, shown.classes, shown.probabilities, ORANGE, "{:.1%}")


def bars(
    place: Axes, labels: Sequence[str], values: Sequence[float], colour: str, form: str
) -> None:
    """Draw one bar per class, with its value."""
    best = int(np.argmax(values))
    heights = range(len(labels))
    shades = [colour if index == best else "#c9ced6" for index in heights]
    place.barh(heights, values, color=shades, height=0.72)
    place.set_yticks(heights, labels, size=6.5)
    place.invert_yaxis()
    place.tick_params(length=0)
    place.set_xlim(0, 1.6 * max(values))
    for index, value in enumerate(values):
        place.text(value, index, " " + form.format(value).replace("%", " %"), va="center", size=6.5)
    for spine in place.spines.values():
        spine.set_visible(False)


# Certainty, intervals, stability ---------------------------------------------------------------------------------


def draw_certainty() -> Figure:
    """Draw accuracy, coverage of prediction sets, and share called unknown of untypical objects."""
    answers = read_table(EVALUATION, ROOT / "studies" / "trust" / "kept_odd.parquet")
    found = summarise_evaluation(answers, IntervalParameters())
    figure, axes = plt.subplots(1, 3, figsize=(WIDTH, 2.1), sharey=True, layout="constrained")
    words = [f"{row['strategy']}, {row['views']} view{'s' * (row['views'] > 1)}" for row in found]
    for place, name, title in (
        (axes[0], "accuracy", "correctly classified (%)"),
        (axes[1], "coverage", "sets that hold the class (%)"),
        (axes[2], "false_unknown", "called unknown (%)"),
    ):
        for index, row in enumerate(found):
            mean, low, high = (100 * value for value in row[name])
            colour = BLUE if row["strategy"] == "fixation" else ORANGE
            place.plot([low, high], [index, index], color=colour, lw=1.6)
            place.plot(mean, index, "o", color=colour, ms=4)
            place.text(mean, index - 0.2, f"{mean:.0f}", ha="center", va="bottom", size=6.5)
        place.set_xlim(0, 105)
        place.set_xticks([0, 25, 50, 75, 100])
        place.set_title(title)
    for place, stated, words_of_line, side in (
        (axes[1], 90, "stated: ≥ 90 ", "right"),
        (axes[2], 10, " stated: ≤ 10", "left"),
    ):
        place.axvline(stated, color=INK, lw=0.9, ls="--")
        place.text(stated, -0.9, words_of_line, ha=side, va="center", size=6.5)
    axes[0].set_yticks(range(len(words)), words)
    axes[0].set_ylim(len(words) - 0.5, -1.3)
    return figure


def draw_intervals() -> Figure:
    """Draw a lead by class with both intervals, and how wide intervals are by number of objects."""
    settings = IntervalParameters()
    kept = read_kept_leads(settings)
    [lead] = [
        lead
        for lead in kept.leads
        if (lead.name, lead.pipeline, lead.turns, lead.known) == ("seeing", "paper", "none", "full")
    ]
    figure, (left, right) = plt.subplots(1, 2, figsize=(WIDTH, 2.7), layout="constrained")
    kinds = sorted(lead.by_class, key=lambda name: -lead.by_class[name].mean)
    for row, category in enumerate(kinds):
        left.plot(100 * lead.by_class[category].mean, row, "o", color=GREY, mec=INK, mew=0.5, ms=4)
    found = lead.difference
    for row, low, high, colour in (
        (len(kinds), found.low, found.high, BLUE),
        (len(kinds) + 1, found.new_classes_low, found.new_classes_high, ORANGE),
    ):
        left.plot([100 * low, 100 * high], [row, row], color=colour, lw=2.2)
        left.plot(100 * found.mean, row, "o", color=colour, ms=5)
        ends = f"{points(found.mean)} ({points(low)} to {points(high)})"
        left.text(100 * high + 2, row, ends, va="center", size=6.5)
    left.axvline(0, color=INK, lw=0.8)
    left.set_yticks(range(len(kinds) + 2), [*kinds, "new objects", "new classes"], size=6.5)
    left.set_ylim(len(kinds) + 1.7, -0.7)
    left.set_xlim(-25, 65)
    left.set_xlabel("lead of fixations over random places in reach (points)")
    left.set_title(f"{lead.objects} objects of {len(kinds)} classes")
    counts = [4, 6, 8, 10, 12, 16, 20, 30, 40, 60, 80, 100, 142]
    for share, colour, words in (
        (1.0, BLUE, "all objects right"),
        (0.9, ORANGE, "one in ten wrong"),
    ):
        chosen = [count for count in counts if share == 1 or count % 10 == 0]
        ends = []
        for count in chosen:
            values = np.ones(count)
            values[: round((1 - share) * count)] = 0
            interval = object_interval(values, np.ones(count), settings)
            ends.append((100 * interval.low, 100 * interval.high))
        low, high = zip(*ends, strict=True)
        right.fill_between(chosen, low, high, color=colour, alpha=0.22, lw=0)
        right.plot(chosen, low, color=colour, lw=1.4, marker="o", ms=2.5)
        right.plot(chosen, high, color=colour, lw=1.4)
        right.text(142, low[-1] - 8 + 2 * (share < 1), words, color=colour, ha="right", va="top", size=7)  # fmt: skip
    twelve = 100 * object_interval(np.ones(12), np.ones(12), settings).low
    right.annotate(
        f"12 of 12 right:\n{twelve:.1f} % to 100 %", (12, twelve), (24, 52),
        size=7, color=BLUE, arrowprops={"arrowstyle": "->", "color": BLUE, "lw": 0.8},
    )  # fmt: skip
    right.set_xscale("log")
    right.set_xticks([4, 12, 40, 142], ["4", "12", "40", "142"])
    right.minorticks_off()
    right.set_ylim(30, 101)
    right.set_xlabel("objects")
    right.set_ylabel("interval of new objects (%)")
    right.set_title("what few objects can say")
    return figure


def draw_stability() -> Figure:
    """Draw each error of docs/hard_cases.md as a share of its tolerance, by family."""
    text = (ROOT / "docs" / "hard_cases.md").read_text(encoding="utf-8")
    row = r"^\| (\w+), .* \| ([\d.e+-]+) \| ([\d.e+-]+) \| [^|]*\|[^|]*\|$"
    errors = [(name, float(e) / float(bound)) for name, e, bound in re.findall(row, text, re.M)]
    lists = re.findall(r"^- \*\*(\w+):\*\* (.*(?:\n  .*)*)", text, re.M)
    exact = {name: len(re.findall(r"\([\d,]+\)", items)) for name, items in lists}
    families = list(dict.fromkeys([*(name for name, _ in errors), *exact]))
    figure, place = plt.subplots(figsize=(WIDTH, 2.2), layout="constrained")
    floor = 1e-17
    for height, family in enumerate(families):
        shares = [share for name, share in errors if name == family]
        place.plot(shares, [height] * len(shares), "o", color=BLUE, ms=4.5, alpha=0.75)
        if family in exact:
            place.plot(floor, height, "o", color="white", mec=BLUE, ms=5)
            place.text(floor * 3, height, str(exact[family]), va="center", size=7)
    place.axvline(1, color=INK, lw=1, ls="--")
    place.text(1.6, -0.75, "tolerance", va="center", size=7)
    place.set_xscale("log")
    place.set_xlim(floor / 4, 60)
    powers = range(-15, 1, 3)
    words = [f"10$^{{{power}}}$" for power in powers]
    place.set_xticks([floor, *(10.0**power for power in powers)], ["no error", *words])
    place.minorticks_off()
    place.set_yticks(range(len(families)), families)
    place.set_ylim(len(families) - 0.5, -1.1)
    place.set_xlabel("worst error as a share of its tolerance")
    return figure


# Saving ----------------------------------------------------------------------------------------------------------

DRAWINGS: dict[str, Callable[[], Figure]] = {
    "attention": draw_attention,
    "section": draw_section,
    "effects": draw_effects,
    "strategies": draw_strategies,
    "policy": draw_policy,
    "environment": draw_environment,
    "recognition": draw_recognition,
    "certainty": draw_certainty,
    "intervals": draw_intervals,
    "stability": draw_stability,
}


def save(figure: Figure, path: Path) -> None:
    """Write a figure as a PNG of 256 colours; the same figure has the same bytes."""
    buffer = io.BytesIO()
    figure.savefig(buffer, dpi=DOTS, metadata={"Software": None})
    plt.close(figure)
    picture = Image.open(buffer).convert("RGB").quantize(256, Image.Quantize.MEDIANCUT, kmeans=2)
    picture.save(path, optimize=True)
    if path.stat().st_size > LARGEST_BYTES:
        raise SystemExit(f"{path} has {path.stat().st_size} bytes; {LARGEST_BYTES} are allowed.")


if __name__ == "__main__":
    with plt.rc_context(STYLE):
        for name in sys.argv[1:] or DRAWINGS:
            save(DRAWINGS[name](), PICTURES / f"{name}.png")
