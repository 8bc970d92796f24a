"""What the eye describes of a view: histograms of gradients, in good sight and in poor."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from eye_and_touch.study import CLEAN, CUES
from visuohaptic.fixations.rendering import Views
from visuohaptic.geometry.srgb import decode_srgb, encode_srgb

FINEST = 128
"""Rows and columns of the eye's picture, at most (pixels); of a finer view every second or later pixel is taken."""

WINDOW = 64
"""Rows and columns of the picture that is described (pixels)."""

LEAST_CONTRAST = 2
"""By how many of 255 levels an object's colour differs from a background without noise."""

LIGHT = 0.02
"""Share of the light that is left in the dark."""

READ_NOISE = 0.002
"""Standard deviation of a camera's noise (share of full light)."""

GRAIN = 0.1
"""Standard deviation of noise in a noisy view (share of the sRGB range)."""

BLUR = 0.04
"""Standard deviation of a blurred view's Gaussian (share of its width)."""

HIDDEN = 0.5
"""Share of the object's pixels behind the board of an occluded view."""

BOARD = 0.5
"""Grey level of the board (sRGB)."""

STRIPES = 0.25
"""Length of a wave of the unknown texture (object radii)."""

DARKEST = 0.1
"""Share of the light that the unknown texture's dark places leave."""


@dataclass(frozen=True)
class Seen:
    """One view: colours (h, w, 3), sRGB 0 to 1; where the object is, (h, w); and its points, (h, w, 3)."""

    colour: NDArray[np.float64]
    mask: NDArray[np.bool_]
    point: NDArray[np.float64]


Sight = Callable[[Seen, np.random.Generator], NDArray[np.float64]]
"""Gives the colours (h, w, 3) that the eye gets of a view."""


def _clean(view: Seen, _: np.random.Generator) -> NDArray[np.float64]:
    return view.colour


def _dark(view: Seen, generator: np.random.Generator) -> NDArray[np.float64]:
    """Leave little light, to which the camera adds its noise before it sets the exposure."""
    light = LIGHT * decode_srgb(view.colour)
    light = light + generator.normal(scale=READ_NOISE, size=light.shape)
    return encode_srgb(np.clip(light / LIGHT, 0, 1))


def _noisy(view: Seen, generator: np.random.Generator) -> NDArray[np.float64]:
    return view.colour + generator.normal(scale=GRAIN, size=view.colour.shape)


def _occluded(view: Seen, generator: np.random.Generator) -> NDArray[np.float64]:
    """Put a board before one side of the object, which is drawn."""
    rows, columns = np.nonzero(view.mask)
    if not len(rows):
        return view.colour
    along, sign = (rows, columns)[generator.integers(2)], 1 - 2 * generator.integers(2)
    edge = np.quantile(sign * along, HIDDEN)
    lines = np.indices(view.mask.shape)[0 if along is rows else 1]
    return np.where((sign * lines <= edge)[..., None], BOARD, view.colour)


def _blurred(view: Seen, _: np.random.Generator) -> NDArray[np.float64]:
    return cv2.GaussianBlur(view.colour, (0, 0), BLUR * view.colour.shape[1])


def _textured(view: Seen, generator: np.random.Generator) -> NDArray[np.float64]:
    """Paint the object with the product of two plane waves, whose directions are drawn."""
    directions = generator.normal(size=(2, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    phases = 2 * np.pi * (view.point @ directions.T / STRIPES + generator.uniform(size=2))
    pattern = (1 + np.sin(phases).prod(axis=-1)) / 2
    light = decode_srgb(view.colour) * (DARKEST + (1 - DARKEST) * pattern)[..., None]
    return np.where(view.mask[..., None], encode_srgb(light), view.colour)


SIGHTS: Mapping[str, Sight] = {
    CLEAN: _clean,
    "dark": _dark,
    "noisy": _noisy,
    "occluded": _occluded,
    "blurred": _blurred,
    "textured": _textured,
}
"""How well the eye sees, by name; nothing is learnt in any but the first."""


def describe_views(
    views: Views, generators: Mapping[str, list[np.random.Generator]]
) -> dict[str, NDArray[np.float32]]:
    """Describe n views in every sight: by cue (n, sights, d), float32, sights in the order of `SIGHTS`.

    `generators` holds, by sight, one for each view.
    """
    found: dict[str, list[list[NDArray[np.float32]]]] = {cue: [] for cue in CUES}
    for place in range(len(views)):
        view = _picture(views, place)
        pictures = [sight(view, generators[name][place]) for name, sight in SIGHTS.items()]
        found["view"].append([gradient_histograms(as_bytes(one)) for one in pictures])
        found["outline"].append([gradient_histograms(cut_out(as_bytes(one))) for one in pictures])
    return {cue: np.array(of_views) for cue, of_views in found.items()}


def _picture(views: Views, place: int) -> Seen:
    step = max(1, views.mask.shape[1] // FINEST)
    taken = (place, slice(None, None, step), slice(None, None, step))
    return Seen(views.colour[taken].astype(np.float64), views.mask[taken], views.point[taken])


def as_bytes(colour: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Round colours of 0 to 1 to bytes; what is outside is clipped."""
    return np.round(255 * np.clip(colour, 0, 1)).astype(np.uint8)


def cut_out(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Cut the object out of a picture (h, w, 3): 255 where it differs from the background, else 0.

    The background's colour is the median along the picture's border, its noise four times the
    median deviation there; single pixels are dropped by a median over 3 × 3.
    """
    border = np.concatenate([picture[0], picture[-1], picture[:, 0], picture[:, -1]])
    background = np.median(border, axis=0)
    noise = 4 * np.median(np.abs(border - background), axis=0)
    differs = (np.abs(picture - background) > LEAST_CONTRAST + noise).any(axis=2)
    return cv2.medianBlur(255 * differs.astype(np.uint8), 3)


def gradient_histograms(picture: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Describe a picture, (h, w) or (h, w, 3), by histograms of oriented gradients.

    As N. Dalal and B. Triggs (CVPR 2005): cells of 8 × 8 pixels, 9 directions, blocks of 2 × 2
    cells, on the square root of the grey picture at 64 × 64 pixels. Shape (1764,), float32.
    """
    if picture.ndim == 3:
        picture = cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY)
    small = cv2.resize(picture, (WINDOW, WINDOW), interpolation=cv2.INTER_AREA)
    histograms = cv2.HOGDescriptor((WINDOW, WINDOW), (16, 16), (8, 8), (8, 8), 9)
    return np.asarray(histograms.compute(small), dtype=np.float32).reshape(-1)
