"""Draw the layouts of pads, pressed on one object, for the page of the sensor: `python docs/make_pads.py`."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from visuohaptic.exploration.pressing import press
from visuohaptic.exploration.showing import view_of
from visuohaptic.geometry.pads import PADS
from visuohaptic.geometry.surface import Surface
from visuohaptic.sensor.example_shapes import hard_probes
from visuohaptic.sensor.frames import column_axes

PICTURE = Path(__file__).parent / "pictures" / "pads.png"
OBJECT = "cup, handle"
WIDTHS = {"gripper": 0.14}
"""Widths of pads, object radii; 0.3 for all other layouts."""

SUNK = 0.04
"""Depth of the pads' origin below the crest of the handle, object radii; the gripper reaches around the handle."""

DEPTH = 0.1
PIXELS = 230
GAP = 16
LARGEST_BYTES = 200_000


def draw_pads() -> Image.Image:
    """Draw the object and each layout pressed on its handle, coloured by reading, in two columns."""
    probe = next(probe for probe in hard_probes() if probe.name == OBJECT)
    point, normal = np.array(probe.point), np.array(probe.normal)
    drawings = []
    for name in PADS:
        deep = 0.1 if name == "gripper" else SUNK
        felt = press(
            probe.surface,
            points=[point - deep * normal],
            normals=[normal],
            size=WIDTHS.get(name, 0.3),
            resolution=16,
            depth=DEPTH,
            layout=name,
        )
        drawings.append(felt.layout_picture())
    drawings.insert(0, _object(probe.surface, point, normal, drawings[0].size))
    wide, high = drawings[0].size
    picture = Image.new("RGB", (2 * wide + 3 * GAP, 3 * (high + GAP) + GAP), "white")
    for number, drawing in enumerate(drawings):
        row, column = divmod(number, 2)
        picture.paste(drawing, (GAP + column * (wide + GAP), GAP + row * (high + GAP)))
    return picture


def _object(
    surface: Surface, point: np.ndarray, normal: np.ndarray, size: tuple[int, int]
) -> Image.Image:
    view = Image.open(io.BytesIO(view_of(surface))).convert("RGB")
    edge = size[1] - 22
    picture = Image.new("RGB", size, "white")
    picture.paste(view.resize((edge, edge)), (0, 22))
    pen, font = ImageDraw.Draw(picture), ImageFont.load_default(13)
    pen.text((4, 3), "the object: a cup, pressed on its handle", fill=(30, 34, 40), font=font)
    x = column_axes(normal[None])[0]
    words = [
        "yellow: contact",
        f"violet: {DEPTH:g} away or more",
        "pads 0.3 wide; gripper 0.14 wide",
        f"at ({', '.join(f'{value:.2f}' for value in point)})",
        f"x of the pad: ({', '.join(f'{value:.0f}' for value in x)})",
        "lengths in object radii",
    ]
    pen.multiline_text((edge + 20, 60), "\n".join(words), fill=(30, 34, 40), font=font, spacing=8)
    return picture


if __name__ == "__main__":
    draw_pads().save(PICTURE, optimize=True)
    if PICTURE.stat().st_size > LARGEST_BYTES:
        raise SystemExit(
            f"{PICTURE} has {PICTURE.stat().st_size} bytes; {LARGEST_BYTES} are allowed."
        )
