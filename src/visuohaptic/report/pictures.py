"""Pictures small enough to lie within a page."""

from __future__ import annotations

import base64
import io
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from PIL import Image

if TYPE_CHECKING:
    from visuohaptic.fixations.viewpoints import Camera

_QUALITY = 75
# Of imprints that are looked at one by one, beside the lossless ones.
_SHEET_QUALITY = 50


def data_uri(data: bytes, kind: str) -> str:
    """Give bytes as an address that holds them, for example of the kind ``image/png``."""
    return f"data:{kind};base64,{base64.b64encode(data).decode('ascii')}"


def webp_address(data: bytes) -> str:
    """Give a WebP picture as an address that holds it."""
    return data_uri(data, "image/webp")


def shrink_picture(png: bytes, factor: int = 1) -> bytes:
    """Store a PNG again as lossy WebP; `factor` pixels along each edge become one, by their mean."""
    with Image.open(io.BytesIO(png)) as picture:
        return _webp(picture.reduce(factor), quality=_QUALITY)


def picture_size(data: bytes) -> tuple[int, int]:
    """Give the rows and columns of a stored picture."""
    with Image.open(io.BytesIO(data)) as picture:
        columns, rows = picture.size
    return rows, columns


def imprint_strip(imprints: NDArray[np.float32]) -> bytes:
    """Store imprints (n, r, r) in [0, 1] side by side as a grey WebP picture; nothing is lost beyond 8 bits."""
    grey = np.rint(255.0 * imprints).astype(np.uint8)
    count, rows, columns = grey.shape
    strip = np.ascontiguousarray(grey.transpose(1, 0, 2)).reshape(rows, count * columns)
    return _webp(Image.fromarray(strip), lossless=True)


def imprint_sheet(
    imprints: NDArray[np.float32],
    rows: NDArray[np.int64],
    columns: NDArray[np.int64],
) -> bytes:
    """Store imprints (n, r, r), n at least 1, in [0, 1] as one lossy grey WebP picture.

    `rows` and `columns` (n,) are the cell of each, of r pixels; cells without an imprint stay black.
    """
    size = imprints.shape[1]
    cells = np.zeros((rows.max() + 1, columns.max() + 1, size, size), dtype=np.uint8)
    cells[rows, columns] = np.rint(255.0 * imprints)
    height, width = cells.shape[0] * size, cells.shape[1] * size
    sheet = np.ascontiguousarray(cells.swapaxes(1, 2)).reshape(height, width)
    return _webp(Image.fromarray(sheet), quality=_SHEET_QUALITY)


def _webp(picture: Image.Image, **options: int) -> bytes:
    stored = io.BytesIO()
    # Pillow's effort 4, its default, takes twice the time of 2 for 7 % fewer bytes.
    picture.save(stored, "webp", method=2, **options)
    return stored.getvalue()


def project(camera: Camera, points: NDArray[np.float64], resolution: int) -> NDArray[np.float64]:
    """Find where points (n, 3) of the object frame, in front of a camera, appear in its view.

    Gives (n, 2): column and row in pixels from the upper left corner of a view of `resolution` pixels
    along each edge; the first pixel's centre is at 0.5. The inverse of `Camera.rays`.
    """
    right, up, back = camera.axes
    if camera.projection == "orthographic":
        depth = np.full(len(points), camera.distance)
    else:
        depth = camera.distance - points @ back
    pixels = resolution / (2.0 * np.tan(np.radians(camera.field_of_view_degrees) / 2.0))
    across, down = points @ right / depth, -(points @ up) / depth
    return 0.5 * resolution + pixels * np.column_stack([across, down])


def square_corners(
    points: NDArray[np.float64],
    columns: NDArray[np.float64],
    rows: NDArray[np.float64],
    sizes: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Give the corners (n, 4, 3) of the sensor's squares, going around, at their true size.

    `points`, `columns` and `rows` (n, 3) are centres, and unit vectors along columns and rows; `sizes`
    (n,) the edge of each square in object radii.
    """
    half = 0.5 * sizes[:, None]
    across, down = half * columns, half * rows
    turns = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return np.stack([points + a * across + b * down for a, b in turns], axis=1)
