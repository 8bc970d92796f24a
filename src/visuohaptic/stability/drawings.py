"""Small drawings of hard cases, as SVG that follows the page's colours."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

SIZE = 120


def _svg(body: str, label: str) -> str:
    return (
        f'<svg viewBox="0 0 {SIZE} {SIZE}" width="{SIZE}" height="{SIZE}" role="img" '
        f'aria-label="{label}">{body}</svg>'
    )


def triangles(corners: ArrayLike, label: str, ray: ArrayLike | None = None, most: int = 60) -> str:
    """Draw triangles seen along z (x right, y up), and a ray, shape (2, 3)."""
    shown = np.asarray(corners, dtype=np.float64)[:most].reshape(-1, 3)
    points = (shown if ray is None else np.vstack([shown, ray]))[:, :2]
    low, high = points.min(axis=0), points.max(axis=0)
    scale = (SIZE - 16) / max(float((high - low).max()), 1e-30)
    places = SIZE / 2 + (points - 0.5 * (low + high)) * scale * [1, -1]
    written = [f"{x:.1f},{y:.1f}" for x, y in places[: len(shown)]]
    body = "".join(
        f'<polygon points="{" ".join(triangle)}" fill="currentColor" '
        'fill-opacity="0.12" stroke="currentColor" stroke-width="0.8"/>'
        for triangle in zip(written[::3], written[1::3], written[2::3], strict=True)
    )
    if ray is not None:
        (x1, y1), (x2, y2) = places[-2:]
        body += (
            f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="#c01860" '
            'stroke-width="1.5"/>'
            f'<circle cx="{x1:.1f}" cy="{y1:.1f}" r="2.5" fill="#c01860"/>'
        )
    return _svg(body, label)


def image(pixels: ArrayLike, label: str) -> str:
    """Draw an image as 16 × 16 cells or fewer, stretched to its own range."""
    pixels = np.asarray(pixels, dtype=np.float64)
    step = max(1, -(-max(pixels.shape) // 16))
    pixels = pixels[::step, ::step]
    with np.errstate(all="ignore"):
        shifted = pixels - pixels.min()
        peak = shifted.max()
        grey = np.nan_to_num(shifted / peak) if peak > 0 else np.zeros_like(pixels)
    cell = SIZE / max(pixels.shape)
    body = f'<rect width="{SIZE}" height="{SIZE}" fill="#000"/>'
    for (row, column), value in np.ndenumerate(grey):
        if value > 0:
            level = int(255 * value)
            body += (
                f'<rect x="{column * cell:.1f}" y="{row * cell:.1f}" width="{cell:.1f}" '
                f'height="{cell:.1f}" fill="#{level:02x}{level:02x}{level:02x}"/>'
            )
    return _svg(body, label)
