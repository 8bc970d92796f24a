"""The eight channels: their feature planes of a view, on the working image.

No plane depends on the view's brightness, and each is multiplied by the certainty of its pixels, so
that only the object counts.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from .levels import CENTRE_LEVELS
from .plain_filters import plain_kernel
from .planes import Plane
from .pyramid import (
    GOES_ON,
    blur,
    enlarge,
    filled,
    reciprocal,
    reduce,
    reductions,
    to_working_size,
)

# Gabor angles, evenly spread over half a turn: 0, 45, 90 and 135° (Itti, Koch & Niebur 1998).
ORIENTATIONS = 4
GABOR_SIZE = 9
GABOR_PERIOD = 7.0
GABOR_DEVIATION = 7.0 / 3.0
WINDOW_DEVIATION = 3.0
# Below this share of the brightest value, hue is noise (Itti, Koch & Niebur 1998).
DARK = np.float32(0.1)
# A view below this is black: denormal numbers have lost their digits, and their reciprocal overflows.
DARKEST = float(np.finfo(np.float32).tiny)
# Gradients, fractions of full scale per pixel, from which votes for symmetry count at all and fully.
FAINT_GRADIENT = 0.01
STRONG_GRADIENT = 0.1
RADIAL_STRICTNESS = 2.0
# Votes at which a centre counts as fully symmetric: half of the 9.9 of Loy & Zelinsky 2003, as
# half the rows and columns have half the pixels around a circle.
FULL_SYMMETRY = 4.95
# Distances at which symmetry is looked for, pixels of the working image: 3 to 9 % of the view; our choice.
SYMMETRY_RADII = (4, 8, 12)
# Grey levels of the local histogram; our choice: a window of 10 × 10 pixels holds some six pixels per level.
ENTROPY_BINS = 16


@dataclass(frozen=True)
class WorkingView:
    """A view on the working image; every plane is (n, n), float32.

    `certainty` is the share of each pixel on the object; `colour` holds red, green and blue there as
    fractions of the brightest value on it, and `intensity` their mean. `backdrop` is intensity, extended
    beyond the object; `curvature` the logarithm of 1 + the surface's curvedness.
    """

    certainty: Plane
    colour: tuple[Plane, Plane, Plane]
    intensity: Plane
    backdrop: Plane
    curvature: Plane


def prepare_view(colour: Plane, mask: NDArray[np.bool_], curvature: Plane) -> WorkingView:
    """Resample a view's colour (h, w, 3), mask (h, w) and curvature (h, w) to the working image."""
    share = mask.astype(np.float32)
    inside = mask.view(np.uint8)
    hues = cv2.split(np.ascontiguousarray(colour))
    peak = max(cv2.minMaxLoc(hue, inside)[1] for hue in hues)
    scale = share / np.float32(peak) if peak >= DARKEST else np.zeros_like(share)
    working = to_working_size(cv2.merge([share, *(hue * scale for hue in hues)]))
    certainty = np.ascontiguousarray(working[:, :, 0])
    sure = reciprocal(certainty)
    red, green, blue = (plane * sure for plane in cv2.split(working)[1:])
    bend = to_working_size(curvature * share) * sure
    intensity = (red + green + blue) * np.float32(1.0 / 3.0)
    return WorkingView(
        certainty,
        (red, green, blue),
        intensity,
        filled(intensity * certainty, certainty),
        cv2.log(np.maximum(bend, 0.0) + np.float32(1.0)),
    )


def colour_planes(view: WorkingView) -> list[Plane]:
    """Red-green and blue-yellow opponency: (r - g) and (b - min(r, g)) over the largest of the three.

    Walther & Koch 2006, "Modeling attention to salient proto-objects". Both signs are kept: centre minus
    surround of the signed plane is the double opponency.
    """
    red, green, blue = view.colour
    bright: Plane = np.maximum(np.maximum(red, green), np.maximum(blue, DARK))
    return [
        (red - green) / bright * view.certainty,
        (blue - np.minimum(red, green)) / bright * view.certainty,
    ]


def intensity_planes(view: WorkingView) -> list[Plane]:
    """Mean of red, green and blue (Itti, Koch & Niebur 1998)."""
    return [view.intensity * view.certainty]


def contrast_planes(view: WorkingView) -> list[Plane]:
    """Local root mean square contrast: deviation over mean in a Gaussian window.

    Moulden, Kingdom & Gatley 1990; Reinagel & Zador 1999 for its effect on fixations. A tenth of full
    scale is added to the mean: below it the eye does not adapt further.
    """
    weight = reciprocal(_window(view.certainty))
    mean = _window(view.intensity * view.certainty) * weight
    variance = _window((view.intensity - mean) ** 2 * view.certainty) * weight
    return [np.sqrt(np.maximum(variance, 0.0)) / (mean + DARK) * view.certainty]


def curvature_planes(view: WorkingView) -> list[Plane]:
    """Logarithm of the curvedness of the surface (Lee, Varshney & Jacobs 2005, "Mesh saliency")."""
    return [view.curvature * view.certainty]


def edge_planes(view: WorkingView) -> list[Plane]:
    """Length of the gradient of intensity by Scharr's operator, full scale per pixel."""
    across, down = _gradient(view.backdrop)
    length: Plane = np.sqrt(across**2 + down**2)
    return [length * view.certainty]


def entropy_planes(view: WorkingView) -> list[Plane]:
    """Entropy of the grey levels in a window, as a fraction of the largest possible.

    Kadir & Brady 2001, "Saliency, scale and image description". Each pixel is shared between the two
    nearest grey levels, so that the plane depends on grey continuously.
    """
    position = np.minimum(view.intensity, 1.0) * np.float32(ENTROPY_BINS - 1)
    weight = reciprocal(_box(view.certainty))
    entropy = np.zeros_like(weight)
    for start in range(0, ENTROPY_BINS, 4):
        members = [
            np.maximum(1.0 - np.abs(position - np.float32(level)), 0.0) * view.certainty
            for level in range(start, start + 4)
        ]
        share = np.maximum(_box(cv2.merge(members)) * cv2.merge([weight] * 4), np.float32(1e-12))
        entropy -= sum(cv2.split(share * cv2.log(share)))
    fraction = np.maximum(entropy / np.float32(np.log(ENTROPY_BINS)), np.float32(0.0))
    return [enlarge(fraction, len(view.certainty)) * view.certainty]


def symmetry_planes(view: WorkingView) -> list[Plane]:
    """Radial symmetry by gradient votes, dark and bright centres alike, on half the working image's pixels.

    Loy & Zelinsky 2003, "Fast radial symmetry for detecting points of interest". A vote is shared between
    the four pixels around its point, and faint gradients have a fraction of one, for continuity.
    """
    across, down = _gradient(reduce(view.backdrop, GOES_ON))
    certainty = reduce(view.certainty).reshape(-1)
    length = np.sqrt(across**2 + down**2)
    strength = length.reshape(-1)
    voters = np.flatnonzero((strength > FAINT_GRADIENT) & (certainty > 0.0))
    strength, certainty = strength[voters], certainty[voters]
    unit = np.stack([down.reshape(-1)[voters], across.reshape(-1)[voters]]) / strength
    magnitude = (strength - FAINT_GRADIENT) * certainty
    ballot = np.minimum(magnitude / (STRONG_GRADIENT - FAINT_GRADIENT), 1.0)
    places = np.stack(np.divmod(voters, length.shape[1]))
    total = np.zeros_like(length)
    for radius in SYMMETRY_RADII:
        steps = np.float32(0.5 * radius) * unit
        ballots, magnitudes = _cast_votes(places, steps, (ballot, magnitude), length.shape)
        share = np.minimum(ballots / FULL_SYMMETRY, 1.0)
        votes = magnitudes / FULL_SYMMETRY * share**RADIAL_STRICTNESS
        total += np.float32(radius) * cv2.GaussianBlur(
            votes, (0, 0), 0.125 * radius, borderType=cv2.BORDER_CONSTANT
        )
    mean = total / np.float32(len(SYMMETRY_RADII))
    return [enlarge(mean, len(view.certainty)) * view.certainty]


def orientation_planes(view: WorkingView) -> list[list[Plane]]:
    """Local energy of Gabor pairs at each angle, minus the mean over all angles, on each level.

    Itti, Koch & Niebur 1998, with their authors' filters: 9 x 9 pixels, period 7, deviation 7/3, zero mean,
    unit norm. Angles inhibit each other (Heeger 1992, "Normalization of cell responses in cat striate
    cortex"), or the two ends of an upright bar would count as two horizontal bars.
    """
    images = reductions(view.backdrop, max(CENTRE_LEVELS), GOES_ON)
    certainties = reductions(view.certainty, max(CENTRE_LEVELS))
    planes = []
    for level in CENTRE_LEVELS:
        angles = _gabor_energies(images[level], ORIENTATIONS)
        energies = [blur(energy, GOES_ON) for energy in angles]
        mean = sum(energies[1:], energies[0]) / np.float32(len(energies))
        above = [np.maximum(energy - mean, np.float32(0.0)) for energy in energies]
        planes.append([plane * certainties[level] for plane in above])
    return planes


@cache
def _gabor_pair(angle: float) -> tuple[list[Plane], list[Plane], list[Plane]]:
    """Give a pair of Gabor filters as sums of products of a row and a column, and the pair mirrored at a column."""
    # Cosine and sine of the wave, by the Gaussian, across and down; of the pair and of the mirrored
    # one, 1 / norm of the even filter, its mean, and 1 / norm of the odd one.
    reach = np.arange(GABOR_SIZE) - GABOR_SIZE // 2
    envelope = np.exp(-(reach**2) / (2.0 * GABOR_DEVIATION**2))
    waves = [2.0 * np.pi / GABOR_PERIOD * reach * step for step in (np.cos(angle), np.sin(angle))]
    (cos_x, sin_x), (cos_y, sin_y) = ((envelope * np.cos(w), envelope * np.sin(w)) for w in waves)
    scales = []
    for sign in (1.0, -1.0):
        even = np.outer(cos_y, cos_x) - sign * np.outer(sin_y, sin_x)
        odd = np.outer(cos_y, sin_x) + sign * np.outer(sin_y, cos_x)
        mean = even.mean()
        triple = 1.0 / np.linalg.norm(even - mean), mean, 1.0 / np.linalg.norm(odd)
        scales.append(plain_kernel(triple))
    return list(map(plain_kernel, (cos_x, sin_x))), list(map(plain_kernel, (cos_y, sin_y))), scales


def _gabor_energies(image: Plane, count: int) -> list[Plane]:
    """Give the energy of Gabor pairs at `count` angles over half a turn, zero mean and unit norm each."""
    window = (GABOR_SIZE, GABOR_SIZE)
    sums = cv2.boxFilter(image, -1, window, normalize=False, borderType=GOES_ON)
    energies: dict[int, Plane] = {}
    for index in range(count // 2 + 1):
        across, down, scales = _gabor_pair(np.pi * index / count)
        (cos_cos, sin_cos), (cos_sin, sin_sin) = (
            [_filtered(image, row, column) for row in across] for column in down
        )
        waves = ((cos_cos - sin_sin, sin_cos + cos_sin), (cos_cos + sin_sin, sin_cos - cos_sin))
        for place, (even, odd), scale in zip((index, count - index), waves, scales, strict=True):
            even_scale, mean, odd_scale = scale
            energies[place] = np.sqrt(
                np.square(even_scale * (even - mean * sums)) + np.square(odd_scale * odd)
            )
    return [energies[index] for index in range(count)]


def _filtered(image: Plane, row: Plane, column: Plane) -> Plane:
    if not row.any() or not column.any():
        return np.zeros_like(image)
    return cv2.sepFilter2D(image, -1, row, column, borderType=GOES_ON)


def _gradient(image: Plane) -> tuple[Plane, Plane]:
    across, down = (
        cv2.Scharr(image, -1, *order, scale=1.0 / 32.0, borderType=GOES_ON)
        for order in ((1, 0), (0, 1))
    )
    return across, down


def _window(plane: Plane) -> Plane:
    return cv2.GaussianBlur(plane, (0, 0), WINDOW_DEVIATION, borderType=cv2.BORDER_CONSTANT)


def _box(planes: Plane) -> Plane:
    """Average over a square window, sampled at every other pixel, as it holds no finer detail."""
    half = len(planes) // 2
    coarse = cv2.resize(planes, (half, half), interpolation=cv2.INTER_AREA)
    return cv2.boxFilter(coarse, -1, (5, 5), borderType=cv2.BORDER_CONSTANT)


def _cast_votes(
    places: NDArray[np.int64], steps: Plane, votes: tuple[Plane, Plane], shape: tuple[int, ...]
) -> list[Plane]:
    """Count votes for the point ahead of each place minus those behind it, as absolute values."""
    # A margin holds the votes for points outside the image.
    margin = int(np.ceil(np.abs(steps).max(initial=0.0))) + 1
    rows, columns = shape[0] + 2 * margin, shape[1] + 2 * margin
    indices, shares = [], []
    for sign in (1, -1):
        target = places + sign * steps
        corner = np.floor(target).astype(np.int64)
        lower, right = target - corner
        first = (corner[0] + margin) * columns + corner[1] + margin
        upper, left = sign * (1.0 - lower), 1.0 - right
        lower = sign * lower
        indices += [first, first + 1, first + columns, first + columns + 1]
        shares += [upper * left, upper * right, lower * left, lower * right]
    index, share = np.concatenate(indices), np.stack(shares)
    counts = []
    for weight in votes:
        count = np.bincount(index, (share * weight).reshape(-1), minlength=rows * columns)
        inner = count.reshape(rows, columns)[margin:-margin, margin:-margin]
        counts.append(np.abs(inner).astype(np.float32))
    return counts
