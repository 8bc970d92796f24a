"""Draw how objects stand: each as the eye sees it from viewpoint 0, with its front and up."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from visuohaptic.base.arrays import FloatArray
from visuohaptic.fixations.rendering import render_views
from visuohaptic.fixations.viewpoints import Camera, place_cameras
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.parameters import ExperimentParameters

CELL_PIXELS = 260
"""Rows and columns of the view of an object."""

CELLS_AT_MOST = 400
"""Largest number of objects in a picture, 5,400 pixels wide; a larger picture is hard to open."""

# Wider than the eye's own view, so that the arrows beside the object fit (degrees).
_FIELD_OF_VIEW_DEGREES = 58.0
# Nearer, an arrow would be behind the camera (object radii).
_NEAREST = 2.5
_LENGTH, _SHAFT, _HEAD = 0.3, 0.05, 0.13  # of an arrow, object radii
_FRONT, _UP, _INK, _BACK = (0, 92, 200), (190, 50, 0), (30, 34, 40), (255, 255, 255)
_LINE, _GAP = 18, 8


def draw_standing(key: str, surface: Surface, parameters: ExperimentParameters) -> Image.Image:
    """Draw an object as the eye sees it from viewpoint 0, with arrows to its front (+z) and up (+y).

    Parameters
    ----------
    key : str
        ``class/name`` of the object, written beneath the view.
    surface : Surface
        The surface in the object frame.
    parameters : ExperimentParameters
        Only sections `viewpoints`, `rendering` and `scene` are used. The lens is wider than the run's, so that
        the arrows fit, and the eye is at least 2.5 object radii away.

    Returns
    -------
    PIL.Image.Image
        `CELL_PIXELS` wide, and two lines of text higher.
    """
    first = place_cameras(parameters.viewpoints)[0]
    camera = replace(
        first,
        field_of_view_degrees=_FIELD_OF_VIEW_DEGREES,
        distance=max(first.distance, _NEAREST),
    )
    rendering = parameters.rendering.model_copy(update={"resolution": CELL_PIXELS})
    [view] = render_views(RayCaster(surface), [camera], rendering, parameters.scene.effects).colour
    cell = Image.new("RGB", (CELL_PIXELS, CELL_PIXELS + 2 * _LINE), _BACK)
    cell.paste(Image.fromarray(np.rint(255.0 * view).astype(np.uint8)))
    draw = ImageDraw.Draw(cell)
    corners = surface.vertices[np.unique(surface.faces)]
    low, high = corners.min(axis=0), corners.max(axis=0)
    x_axis, y_axis, z_axis = np.eye(3)
    _draw_arrow(draw, camera, np.array([0.0, low[1], high[2]]), z_axis, x_axis, "front", _FRONT)
    _draw_arrow(draw, camera, np.array([0.0, high[1], 0.0]), y_axis, x_axis, "up", _UP)
    category, name = key.split("/")
    for line, text in enumerate((category, name)):
        _draw_line(draw, CELL_PIXELS + line * _LINE, text)
    return cell


def join_cells(cells: list[Image.Image], across: int | None = None) -> Image.Image:
    """Arrange pictures of one size in rows of `across`; by default the whole is about as wide as high."""
    across = across or math.ceil(math.sqrt(len(cells)))
    width, height = cells[0].width + _GAP, cells[0].height + _GAP
    size = (across * width + _GAP, math.ceil(len(cells) / across) * height + _GAP)
    picture = Image.new("RGB", size, _BACK)
    for number, cell in enumerate(cells):
        down, right = divmod(number, across)
        picture.paste(cell, (right * width + _GAP, down * height + _GAP))
    return picture


def _draw_arrow(
    draw: ImageDraw.ImageDraw,
    camera: Camera,
    start: FloatArray,
    along: FloatArray,
    across: FloatArray,
    label: str,
    colour: tuple[int, int, int],
) -> None:
    """Draw a flat arrow in the plane of two unit vectors, and its label at the tip."""
    neck = _LENGTH - 1.5 * _HEAD
    outline = [
        (0.0, -_SHAFT), (neck, -_SHAFT), (neck, -_HEAD), (_LENGTH, 0.0),
        (neck, _HEAD), (neck, _SHAFT), (0.0, _SHAFT),
    ]  # fmt: skip
    points = np.array([start + ahead * along + aside * across for ahead, aside in outline])
    positions = camera.project(points, CELL_PIXELS)
    draw.polygon([tuple(position) for position in positions], fill=colour, outline=_BACK)
    draw.text(
        tuple(positions[3] + (14, 0)), label, fill=colour, font=_font(),
        anchor="lm", stroke_width=2, stroke_fill=_BACK,
    )  # fmt: skip


def _draw_line(draw: ImageDraw.ImageDraw, top: int, text: str) -> None:
    """Write a centred line of text; an ellipsis replaces the end of a text that is too wide."""
    font = _font()
    shown = text
    while draw.textlength(shown, font=font) > CELL_PIXELS and len(shown) > 1:
        shown = f"{shown.removesuffix('…')[:-1]}…"
    draw.text((CELL_PIXELS // 2, top), shown, fill=_INK, font=font, anchor="ma")


@cache
def _font() -> ImageFont.ImageFont | ImageFont.FreeTypeFont:
    """Return Matplotlib's font; without Matplotlib return Pillow's font, which has only ASCII."""
    found = find_spec("matplotlib")
    if found is None or found.origin is None:
        return ImageFont.load_default(13)
    font = Path(found.origin).parent / "mpl-data/fonts/ttf/DejaVuSans.ttf"
    return ImageFont.truetype(font, 13)
