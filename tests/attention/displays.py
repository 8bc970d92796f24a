"""Search displays with one known target: a panel of 5 x 5 items with soft edges."""

from dataclasses import dataclass
from functools import cache

import numpy as np

GRID = 5
RED, GREEN, DARK, LIGHT = (0.8, 0.2, 0.2), (0.2, 0.5, 0.2), (0.15,) * 3, (0.9,) * 3
PANEL = (0.5, 0.5, 0.5)


@dataclass(frozen=True)
class Item:
    angle_degrees: float = 90.0
    colour: tuple[float, float, float] = LIGHT
    length: float = 0.6
    width: float = 0.18


def draw(items, size=256, rows=None):
    """Return a display as (h, w, 3) float32; items is 25 long, row by row."""
    rows = size if rows is None else rows
    image = np.broadcast_to(np.array(PANEL, dtype=np.float32), (rows, size, 3)).copy()
    for place, item in enumerate(items):
        row, column = divmod(place, GRID)
        top, bottom = (round(edge * rows / GRID) for edge in (row, row + 1))
        left, right = (round(edge * size / GRID) for edge in (column, column + 1))
        cell = image[top:bottom, left:right]
        cover = item_cover(place, item, rows, size)[top:bottom, left:right, None]
        cell += cover * (np.array(item.colour, dtype=np.float32) - cell)
    return image


@cache
def item_cover(place, item, rows, columns):
    """Return the share of each pixel that an item covers, (h, w) float32."""
    centre_y, centre_x = cell_centre(place, rows, columns)
    y, x = np.mgrid[:rows, :columns] + 0.5
    pitch = min(rows, columns) / GRID
    angle = np.radians(item.angle_degrees)
    along = (x - centre_x) * np.cos(angle) - (y - centre_y) * np.sin(angle)
    across = (x - centre_x) * np.sin(angle) + (y - centre_y) * np.cos(angle)
    outside = np.maximum(
        np.abs(along) - 0.5 * item.length * pitch, np.abs(across) - 0.5 * item.width * pitch
    )
    return np.clip(0.5 - outside, 0.0, 1.0).astype(np.float32)


def cell_centre(place, rows, columns):
    row, column = divmod(place, GRID)
    return (row + 0.5) * rows / GRID, (column + 0.5) * columns / GRID


def cell_mask(place, rows, columns):
    """Return the target's cell of a display as (h, w) bool."""
    row, column = divmod(place, GRID)
    y, x = np.mgrid[:rows, :columns] + 0.5
    return (np.floor(y * GRID / rows) == row) & (np.floor(x * GRID / columns) == column)


def as_views(image):
    """Return the arguments of `attend` for a flat panel of unit width, seen from the front."""
    rows, columns = image.shape[:2]
    y, x = np.mgrid[:rows, :columns]
    point = np.stack([x / columns, -y / columns, np.zeros_like(x)], axis=-1).astype(float)
    normal = np.broadcast_to([0.0, 0.0, 1.0], point.shape)
    return {
        "colour": image[None],
        "mask": np.ones((1, rows, columns), dtype=bool),
        "point": point[None],
        "normal": normal[None],
        "face": np.zeros((1, rows, columns), dtype=np.int64),
        "curvature": np.zeros((1, rows, columns), dtype=np.float32),
    }
