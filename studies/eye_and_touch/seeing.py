"""Describe views by histograms of gradients, in good and in poor sight."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from eye_and_touch.study import CLEAN, CUES
from meshreaders.base.srgb import decode_srgb, encode_srgb
from visuohaptic.fixations.rendering import Views

FINEST = 128
"""Largest number of rows and columns of the eye's picture (pixels). Finer views are subsampled by a whole step."""

WINDOW = 64
"""Rows and columns of the resized picture from which histograms are computed (pixels)."""

LEAST_CONTRAST = 2
"""Least difference between an object's colour and a background without noise (levels of 255)."""

LIGHT = 0.02
"""Share of full light in the dark."""

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
"""Wavelength of the unknown texture (object radii)."""

DARKEST = 0.1
"""Share of the light that the darkest parts of the unknown texture reflect."""


@dataclass(frozen=True)
class Seen:
    """One view: `colour` (h, w, 3), sRGB 0 to 1; `mask` (h, w) of the object; `point` (h, w, 3) in object radii."""

    colour: NDArray[np.float64]
    mask: NDArray[np.bool_]
    point: NDArray[np.float64]


Sight = Callable[[Seen, np.random.Generator], NDArray[np.float64]]
"""Returns the colours (h, w, 3) that the eye receives from a view."""


def _clean(view: Seen, _: np.random.Generator) -> NDArray[np.float64]:
    return view.colour


def _dark(view: Seen, generator: np.random.Generator) -> NDArray[np.float64]:
    """Return a view in little light: the camera adds read noise, then sets the exposure."""
    light = LIGHT * decode_srgb(view.colour)
    light = light + generator.normal(scale=READ_NOISE, size=light.shape)
    return encode_srgb(np.clip(light / LIGHT, 0, 1))


def _noisy(view: Seen, generator: np.random.Generator) -> NDArray[np.float64]:
    return view.colour + generator.normal(scale=GRAIN, size=view.colour.shape)


def _occluded(view: Seen, generator: np.random.Generator) -> NDArray[np.float64]:
    """Return a view with a board in front of one side of the object; the side is drawn."""
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
    """Return a view with the product of two plane waves of random directions painted on the object."""
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
"""Sights by name; training uses only the first."""


def describe_views(
    views: Views, generators: Mapping[str, list[np.random.Generator]]
) -> dict[str, NDArray[np.float32]]:
    """Compute the descriptors of n views in every sight.

    Parameters
    ----------
    views : Views
        The n views.
    generators : mapping of str to list of Generator
        One random generator per view, by sight.

    Returns
    -------
    dict of str to ndarray of shape (n, sights, d), float32
        Descriptors by cue; sights are in the order of `SIGHTS`.
    """
    histograms: dict[str, list[list[NDArray[np.float32]]]] = {cue: [] for cue in CUES}
    for index in range(len(views)):
        view = _picture(views, index)
        pictures = [
            as_bytes(sight(view, generators[name][index])) for name, sight in SIGHTS.items()
        ]
        histograms["view"].append([gradient_histograms(picture) for picture in pictures])
        histograms["outline"].append(
            [gradient_histograms(cut_out(picture)) for picture in pictures]
        )
    return {cue: np.array(of_views) for cue, of_views in histograms.items()}


def _picture(views: Views, index: int) -> Seen:
    step = max(1, views.mask.shape[1] // FINEST)
    taken = (index, slice(None, None, step), slice(None, None, step))
    return Seen(views.colour[taken].astype(np.float64), views.mask[taken], views.point[taken])


def as_bytes(colour: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Convert colours of 0 to 1 to bytes; values outside of this range are clipped."""
    return np.round(255 * np.clip(colour, 0, 1)).astype(np.uint8)


def cut_out(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Compute the silhouette (h, w) of the object in a picture (h, w, 3), uint8: 255 on the object, else 0.

    The colour of the background is the median along the border of the picture. A pixel belongs to the object if it
    differs by more than `LEAST_CONTRAST` plus four times the median deviation along the border. A median over 3 × 3
    pixels drops single pixels.
    """
    border = np.concatenate([picture[0], picture[-1], picture[:, 0], picture[:, -1]])
    background = np.median(border, axis=0)
    noise = 4 * np.median(np.abs(border - background), axis=0)
    differs = (np.abs(picture - background) > LEAST_CONTRAST + noise).any(axis=2)
    return cv2.medianBlur(255 * differs.astype(np.uint8), 3)


def gradient_histograms(picture: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Compute histograms of oriented gradients of a picture (h, w) or (h, w, 3), uint8: (1764,), float32.

    The picture is turned to grey and resized to 64 × 64 pixels. Histograms are of its square root, with cells of 8 × 8
    pixels, 9 directions and blocks of 2 × 2 cells (N. Dalal and B. Triggs, CVPR 2005).
    """
    if picture.ndim == 3:
        picture = cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY)
    small = cv2.resize(picture, (WINDOW, WINDOW), interpolation=cv2.INTER_AREA)
    histograms = cv2.HOGDescriptor((WINDOW, WINDOW), (16, 16), (8, 8), (8, 8), 9)
    return np.asarray(histograms.compute(small), dtype=np.float32).reshape(-1)
