"""Draw an exploration: views, touched points and imprints."""

from __future__ import annotations

import io
import math

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from PIL import Image, ImageDraw, ImageFont

from visuohaptic.base.arrays import FloatArray
from visuohaptic.fixations.places import is_visible
from visuohaptic.fixations.viewpoints import Camera, place_cameras
from visuohaptic.geometry.layouts import Layout
from visuohaptic.geometry.raycasting import RayCaster
from visuohaptic.geometry.surface import Surface
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.pictures.imprint_scale import imprint_scale
from visuohaptic.pictures.taxels import imprint_images
from visuohaptic.tables.phases import POINT_NAMES
from visuohaptic.tables.schema import matrix
from visuohaptic.touches.touch_table import touch_outlines

VIEW_PIXELS = 320
IMPRINT_PIXELS = 84
IMPRINTS_ACROSS = 3
GAP = 8
LABEL = 16
"""Height of a line of text."""
FIRST_TOUCHES = 9
"""Largest number of touches in the small picture of an exploration; `Exploration.picture` has all touches."""
_BACK, _INK, _MARK, _SQUARE = (255, 255, 255), (30, 34, 40), (255, 214, 0), (0, 92, 200)


def draw_exploration(
    surface: Surface, parameters: ExperimentParameters, views: pa.Table, touches: pa.Table
) -> Image.Image:
    """Draw one cell per viewpoint: the view with its touches, and the imprints beside the view.

    A filled number marks a touch visible from the viewpoint; a hollow number marks a hidden touch. The outline
    is the sensor. The label of an imprint is the sensor's width (object radii) and the contact state. The last line says
    what dark and light mean in an imprint.
    """
    caster, layout = RayCaster(surface), parameters.sensor.taxels
    cameras = place_cameras(parameters.viewpoints)
    owner = touches.column("viewpoint").to_numpy()
    scale = str(imprint_scale(parameters.sensor, parameters.scene))
    if not views.num_rows:
        return _with_line(_grid([_cell("given points", None, touches, layout)]), scale)
    cells = []
    for row in views.to_pylist():
        mine = touches.filter(pa.array(owner == row["viewpoint"]))
        with Image.open(io.BytesIO(row["view"])) as picture:
            view = picture.convert("RGB").resize((VIEW_PIXELS, VIEW_PIXELS))
        _mark_touches(view, caster, cameras[row["viewpoint"]], mine, layout)
        cells.append(_cell(f"viewpoint {row['viewpoint']}", view, mine, layout))
    return _with_line(_grid(cells), scale)


def draw_first_view(
    surface: Surface, parameters: ExperimentParameters, views: pa.Table, touches: pa.Table
) -> Image.Image:
    """Draw as `draw_exploration` the first view and at most its first `FIRST_TOUCHES` touches."""
    views = views.slice(0, 1)
    if views.num_rows:
        touches = touches.filter(pc.field("viewpoint") == views.column("viewpoint")[0].as_py())
    return draw_exploration(surface, parameters, views, touches.slice(0, FIRST_TOUCHES))


def _mark_touches(
    view: Image.Image, caster: RayCaster, camera: Camera, touches: pa.Table, layout: Layout
) -> None:
    points = matrix(touches, POINT_NAMES)
    outlines = camera.project(touch_outlines(touches, layout), VIEW_PIXELS)
    pixels = camera.project(points, VIEW_PIXELS)
    visible = is_visible(caster, camera, points)
    draw = ImageDraw.Draw(view)
    for outline in outlines[visible]:
        draw.polygon([tuple(corner) for corner in outline], outline=_SQUARE, width=2)
    # Draw the first touches last, on top: they matter most.
    for number in reversed(range(len(pixels))):
        _mark(draw, pixels[number], str(number + 1), bool(visible[number]))


def _mark(draw: ImageDraw.ImageDraw, pixel: FloatArray, text: str, seen: bool) -> None:  # noqa: FBT001
    column, row = pixel
    box = (column - 9, row - 9, column + 9, row + 9)
    draw.ellipse(box, fill=_MARK if seen else None, outline=_INK, width=1)
    draw.text((column, row), text, fill=_INK, font=ImageFont.load_default(12), anchor="mm")


def _cell(title: str, view: Image.Image | None, touches: pa.Table, layout: Layout) -> Image.Image:
    imprints = imprint_images(touches, layout)
    sizes = touches.column("sensor_size").to_pylist()
    states = touches.column("contact_state").to_pylist()
    pitch = IMPRINT_PIXELS + LABEL + GAP
    deep = math.ceil(len(imprints) / IMPRINTS_ACROSS) * pitch
    seen = (0, 0) if view is None else view.size
    width = seen[0] + IMPRINTS_ACROSS * (IMPRINT_PIXELS + GAP) + GAP
    cell = Image.new("RGB", (width, LABEL + max(seen[1], deep)), _BACK)
    draw = ImageDraw.Draw(cell)
    draw.text((0, 0), title, fill=_INK, font=ImageFont.load_default(12))
    if view is not None:
        cell.paste(view, (0, LABEL))
    for number, imprint in enumerate(imprints):
        down, across = divmod(number, IMPRINTS_ACROSS)
        left = seen[0] + GAP + across * (IMPRINT_PIXELS + GAP)
        top = LABEL + down * pitch
        grey = Image.fromarray(np.rint(255.0 * imprint).astype(np.uint8)).convert("RGB")
        square = grey.resize((IMPRINT_PIXELS, IMPRINT_PIXELS), Image.Resampling.NEAREST)
        cell.paste(square, (left, top))
        draw.rectangle(
            (left, top, left + IMPRINT_PIXELS - 1, top + IMPRINT_PIXELS - 1), outline=_INK
        )
        label = f"{number + 1}: {sizes[number]:.2f} {states[number].replace('_', ' ')}"
        draw.text(
            (left, top + IMPRINT_PIXELS + 1), label, fill=_INK, font=ImageFont.load_default(10)
        )
    return cell


def _grid(cells: list[Image.Image]) -> Image.Image:
    across = 1 if len(cells) < 3 else 2
    width, height = cells[0].width + 2 * GAP, cells[0].height + 2 * GAP
    picture = Image.new("RGB", (across * width, math.ceil(len(cells) / across) * height), _BACK)
    for number, cell in enumerate(cells):
        down, right = divmod(number, across)
        picture.paste(cell, (right * width + GAP, down * height + GAP))
    return picture


def _with_line(picture: Image.Image, line: str) -> Image.Image:
    """Return a picture with a line of text below, wide enough for both."""
    font = ImageFont.load_default(12)
    width = max(picture.width, math.ceil(font.getlength(line)) + 2 * GAP)
    whole = Image.new("RGB", (width, picture.height + LABEL + GAP), _BACK)
    whole.paste(picture, (0, 0))
    ImageDraw.Draw(whole).text((GAP, picture.height), line, fill=_INK, font=font)
    return whole
