"""Drawings of a layout's taxels, shaded or coloured by their readings."""

from __future__ import annotations

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from visuohaptic.base.arrays import FloatArray
from visuohaptic.geometry.layouts import Layout, nearest_taxels
from visuohaptic.tables.schema import images, readings

# Anchors of matplotlib's viridis at equal steps from 0 to 1, so that no plotting package is needed.
_COLOURS = np.array([(68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37)])
_LARGEST_DISC = 0.12
_INK, _BACK, _EMPTY = (30, 34, 40), (255, 255, 255), 64
_FINER = 4

PIXELS = 32
"""Pixels along an edge of the image of an imprint that is no grid, as many as the default square has."""


def draw_taxels(layout: Layout, values: NDArray[np.floating], pixels: int) -> Image.Image:
    """Draw values (taxels,) in [0, 1] as grey discs on the unrolled pad, light for 1, seen from outside the object."""
    return _discs(layout.chart, layout, _grey(values), pixels, (_EMPTY,) * 3).convert("L")


def draw_layout(layout: Layout, values: NDArray[np.floating], pixels: int = 240) -> Image.Image:
    """Draw a layout coloured by values (taxels,): the unrolled pad, its side in x and z, and the scale.

    Parameters
    ----------
    layout : Layout
        The taxels.
    values : ndarray of shape (taxels,)
        Readings in [0, 1]: dark violet is 0, yellow is 1.
    pixels : int
        Edge of each of the two drawings.

    Returns
    -------
    PIL.Image.Image
        The unrolled pad on the left, as an imprint is seen: x to the right and y upwards. On the right the pad from its
        side: x to the right, and z, away from the object, upwards.
    """
    colours = _viridis(values.ravel())
    side = layout.positions[:, [0, 2]]
    middle = (side.max(axis=0) + side.min(axis=0)) / 2
    drawings = (
        _discs(layout.chart, layout, colours, pixels, _BACK),
        _discs(side - middle, layout, colours, pixels, _BACK),
    )
    picture = Image.new("RGB", (2 * pixels + 8, pixels + 22), _BACK)
    for number, drawing in enumerate(drawings):
        picture.paste(drawing, (number * (pixels + 8), 22))
    pen, font = ImageDraw.Draw(picture), ImageFont.load_default(13)
    pen.text((4, 3), f"{layout.name}: {len(layout)} taxels", fill=_INK, font=font)
    pen.text((pixels + 12, 3), "from the side", fill=_INK, font=font)
    return picture


def imprint_images(touches: pa.Table, layout: Layout) -> NDArray[np.float32]:
    """Return the imprints of rows of `tables.TOUCHES` as images (n, p, p) for pictures; see `as_images`."""
    if len(layout.shape) == 2:
        return images(touches)
    return as_images(layout, readings(touches).reshape(-1, len(layout)))


def as_images(layout: Layout, imprints: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return imprints (n, *layout.shape) as images (n, p, p) for pictures.

    A grid is its own image. Other layouts have `PIXELS` pixels along an edge: each pixel of the unrolled pad has the
    reading of its nearest taxel, or 0 beside the pad.
    """
    if len(layout.shape) == 2:
        return imprints
    index, empty = nearest_taxels(layout, PIXELS)
    return np.where(empty, np.float32(0), imprints[:, index])


def _discs(
    places: FloatArray,
    layout: Layout,
    colours: NDArray[np.uint8],
    pixels: int,
    back: tuple[int, int, int],
) -> Image.Image:
    """Draw one disc per taxel, as wide as the spacing allows, anti-aliased."""
    disc = min(0.92 / max(layout.counts), _LARGEST_DISC)
    reach = max(1.0, float(np.abs(places).max())) + 1.2 * disc
    edge = _FINER * pixels
    scale = edge / (2 * reach)
    radius = max(1.5 * _FINER, scale * disc)
    drawing = Image.new("RGB", (edge, edge), back)
    pen = ImageDraw.Draw(drawing)
    for (x, y), colour in zip(places, colours, strict=True):
        column, row = edge / 2 + scale * x, edge / 2 - scale * y
        box = (column - radius, row - radius, column + radius, row + radius)
        pen.ellipse(box, fill=tuple(colour.tolist()))
    return drawing.resize((pixels, pixels), Image.Resampling.BOX)


def _grey(values: NDArray[np.floating]) -> NDArray[np.uint8]:
    return np.repeat(np.round(255 * values).astype(np.uint8)[:, None], 3, axis=1)


def _viridis(values: NDArray[np.floating]) -> NDArray[np.uint8]:
    anchors = np.linspace(0, 1, len(_COLOURS))
    parts = [np.interp(values, anchors, part) for part in _COLOURS.T]
    return np.round(np.stack(parts, axis=1)).astype(np.uint8)
