"""Feature planes of the eight channels, on the working image of a view.

A view's overall brightness changes no plane. Each plane is multiplied by the certainty of its pixels,
so that only the object counts.
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
    BORDER_REPEATED,
    blur,
    build_pyramid,
    enlarge,
    fill_background,
    reciprocal,
    reduce,
    to_working_size,
)

# Angles of the Gabor filters, evenly spread over half a turn: 0, 45, 90 and 135° (Itti, Koch & Niebur 1998).
ORIENTATIONS = 4
# Sides, wavelength and standard deviation of the Gabor filters, pixels.
GABOR_SIZE = 9
GABOR_PERIOD = 7.0
GABOR_DEVIATION = 7.0 / 3.0
# Standard deviation of the window of local contrast, pixels.
WINDOW_DEVIATION = 3.0
# Below this share of the brightest value, hue is noise (Itti, Koch & Niebur 1998).
DARK = np.float32(0.1)
# A peak below this counts as black: denormal numbers have few digits, and their reciprocal overflows.
DARKEST = float(np.finfo(np.float32).tiny)
# Votes for symmetry start at the faint gradient and count fully from the strong gradient, full scale per pixel.
FAINT_GRADIENT = 0.01
STRONG_GRADIENT = 0.1
# Exponent α of Loy & Zelinsky 2003: larger values demand votes from all around a centre.
RADIAL_STRICTNESS = 2.0
# Votes of a fully symmetric centre: half of the 9.9 of Loy & Zelinsky 2003, because a circle at half the
# resolution has half the pixels.
FULL_SYMMETRY = 4.95
# Radii of the searched symmetry, pixels of the working image: 3 to 9 % of the view. Our choice.
SYMMETRY_RADII = (4, 8, 12)
# Grey levels of the local histogram. Our choice: a window of 10 × 10 pixels holds some six pixels per level.
ENTROPY_BINS = 16


@dataclass(frozen=True)
class WorkingView:
    """A view on the working image; every plane is (n, n), float32.

    Attributes
    ----------
    certainty : ndarray
        Share of each pixel that the object covers, 0 to 1.
    colour : tuple of ndarray
        Red, green and blue of the object, as fractions of its brightest value.
    intensity : ndarray
        Mean of red, green and blue.
    backdrop : ndarray
        Intensity, extended beyond the object.
    curvature : ndarray
        Logarithm of 1 + the surface's curvedness.
    """

    certainty: Plane
    colour: tuple[Plane, Plane, Plane]
    intensity: Plane
    backdrop: Plane
    curvature: Plane


def prepare_view(colour: Plane, mask: NDArray[np.bool_], curvature: Plane) -> WorkingView:
    """Resample a view's colour (h, w, 3), mask (h, w) and curvature (h, w) to the working image."""
    cover = mask.astype(np.float32)
    inside = mask.view(np.uint8)
    hues = cv2.split(np.ascontiguousarray(colour))
    peak = max(cv2.minMaxLoc(hue, inside)[1] for hue in hues)
    scale = cover / np.float32(peak) if peak >= DARKEST else np.zeros_like(cover)
    working = to_working_size(cv2.merge([cover, *(hue * scale for hue in hues)]))
    certainty = np.ascontiguousarray(working[:, :, 0])
    normaliser = reciprocal(certainty)
    red, green, blue = (plane * normaliser for plane in cv2.split(working)[1:])
    curvedness = to_working_size(curvature * cover) * normaliser
    intensity = (red + green + blue) * np.float32(1.0 / 3.0)
    return WorkingView(
        certainty,
        (red, green, blue),
        intensity,
        fill_background(intensity * certainty, certainty),
        cv2.log(np.maximum(curvedness, 0.0) + np.float32(1.0)),
    )


def colour_planes(view: WorkingView) -> list[Plane]:
    """Compute the opponencies red-green, (r - g) / max(r, g, b), and blue-yellow, (b - min(r, g)) / max(r, g, b).

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
    """Return the mean of red, green and blue (Itti, Koch & Niebur 1998)."""
    return [view.intensity * view.certainty]


def contrast_planes(view: WorkingView) -> list[Plane]:
    """Compute the local root mean square contrast: standard deviation over mean in a Gaussian window.

    Moulden, Kingdom & Gatley 1990; its effect on fixations: Reinagel & Zador 1999. A tenth of full scale is
    added to the mean, because the eye adapts no further in darker parts.
    """
    weight = reciprocal(_window(view.certainty))
    mean = _window(view.intensity * view.certainty) * weight
    variance = _window((view.intensity - mean) ** 2 * view.certainty) * weight
    return [np.sqrt(np.maximum(variance, 0.0)) / (mean + DARK) * view.certainty]


def curvature_planes(view: WorkingView) -> list[Plane]:
    """Return the logarithm of the surface's curvedness (Lee, Varshney & Jacobs 2005, "Mesh saliency")."""
    return [view.curvature * view.certainty]


def edge_planes(view: WorkingView) -> list[Plane]:
    """Compute the length of the gradient of intensity by Scharr's operator, full scale per pixel."""
    across, down = _gradient(view.backdrop)
    length: Plane = np.sqrt(across**2 + down**2)
    return [length * view.certainty]


def entropy_planes(view: WorkingView) -> list[Plane]:
    """Compute the entropy of the grey levels in a window, as a fraction of the largest possible entropy.

    Kadir & Brady 2001, "Saliency, scale and image description". Each pixel is divided between the two
    nearest grey levels, so that the plane is continuous in grey.
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
    """Compute the radial symmetry of dark and bright centres by votes of gradients, at half the resolution.

    Loy & Zelinsky 2003, "Fast radial symmetry for detecting points of interest". The plane is continuous in
    the image: a vote is divided between the four nearest pixels, and faint gradients have a fraction of a vote.
    """
    across, down = _gradient(reduce(view.backdrop, BORDER_REPEATED))
    certainty = reduce(view.certainty).reshape(-1)
    length = np.sqrt(across**2 + down**2)
    strength = length.reshape(-1)
    voters = np.flatnonzero((strength > FAINT_GRADIENT) & (certainty > 0.0))
    strength, certainty = strength[voters], certainty[voters]
    unit = np.stack([down.reshape(-1)[voters], across.reshape(-1)[voters]]) / strength
    magnitude = (strength - FAINT_GRADIENT) * certainty
    ballot = np.minimum(magnitude / (STRONG_GRADIENT - FAINT_GRADIENT), 1.0)
    positions = np.stack(np.divmod(voters, length.shape[1]))
    total = np.zeros_like(length)
    for radius in SYMMETRY_RADII:
        steps = np.float32(0.5 * radius) * unit
        ballots, magnitudes = _cast_votes(positions, steps, (ballot, magnitude), length.shape)
        share = np.minimum(ballots / FULL_SYMMETRY, 1.0)
        votes = magnitudes / FULL_SYMMETRY * share**RADIAL_STRICTNESS
        total += np.float32(radius) * cv2.GaussianBlur(
            votes, (0, 0), 0.125 * radius, borderType=cv2.BORDER_CONSTANT
        )
    mean = total / np.float32(len(SYMMETRY_RADII))
    return [enlarge(mean, len(view.certainty)) * view.certainty]


def orientation_planes(view: WorkingView) -> list[list[Plane]]:
    """Compute the energy of Gabor pairs at each angle above the mean over all angles, on each centre level.

    Itti, Koch & Niebur 1998, with the filters of their toolbox: 9 x 9 pixels, period 7, deviation 7/3, zero
    mean, unit norm. The mean is subtracted because angles inhibit each other (Heeger 1992, "Normalization of
    cell responses in cat striate cortex"). Otherwise an upright bar would have a horizontal bar at each end.
    """
    images = build_pyramid(view.backdrop, max(CENTRE_LEVELS), BORDER_REPEATED)
    certainties = build_pyramid(view.certainty, max(CENTRE_LEVELS))
    stacks = []
    for level in CENTRE_LEVELS:
        sharp = _gabor_energies(images[level], ORIENTATIONS)
        energies = [blur(energy, BORDER_REPEATED) for energy in sharp]
        mean = sum(energies[1:], energies[0]) / np.float32(len(energies))
        above_mean = [np.maximum(energy - mean, np.float32(0.0)) for energy in energies]
        stacks.append([plane * certainties[level] for plane in above_mean])
    return stacks


@cache
def _gabor_pair(angle: float) -> tuple[list[Plane], list[Plane], list[Plane]]:
    """Compute rows (cosine, sine), columns (cosine, sine) and scales of a Gabor pair and of its mirror image."""
    # Both pairs are sums of products of these rows and columns. The scales of a pair are 1 / norm of the even
    # filter, the mean of the even filter, and 1 / norm of the odd filter.
    offsets = np.arange(GABOR_SIZE) - GABOR_SIZE // 2
    envelope = np.exp(-(offsets**2) / (2.0 * GABOR_DEVIATION**2))
    waves = [2.0 * np.pi / GABOR_PERIOD * offsets * step for step in (np.cos(angle), np.sin(angle))]
    (cos_x, sin_x), (cos_y, sin_y) = ((envelope * np.cos(w), envelope * np.sin(w)) for w in waves)
    scales = []
    for sign in (1.0, -1.0):
        even = np.outer(cos_y, cos_x) - sign * np.outer(sin_y, sin_x)
        odd = np.outer(cos_y, sin_x) + sign * np.outer(sin_y, cos_x)
        mean = even.mean()
        pair_scales = 1.0 / np.linalg.norm(even - mean), mean, 1.0 / np.linalg.norm(odd)
        scales.append(plain_kernel(pair_scales))
    return list(map(plain_kernel, (cos_x, sin_x))), list(map(plain_kernel, (cos_y, sin_y))), scales


def _gabor_energies(image: Plane, count: int) -> list[Plane]:
    """Compute the energy of Gabor pairs, zero mean and unit norm, at `count` angles over half a turn."""
    window = (GABOR_SIZE, GABOR_SIZE)
    sums = cv2.boxFilter(image, -1, window, normalize=False, borderType=BORDER_REPEATED)
    energies: dict[int, Plane] = {}
    for index in range(count // 2 + 1):
        across, down, scales = _gabor_pair(np.pi * index / count)
        (cos_cos, sin_cos), (cos_sin, sin_sin) = (
            [_filtered(image, row, column) for row in across] for column in down
        )
        waves = ((cos_cos - sin_sin, sin_cos + cos_sin), (cos_cos + sin_sin, sin_cos - cos_sin))
        mirrored = count - index
        for which, (even, odd), scale in zip((index, mirrored), waves, scales, strict=True):
            even_scale, mean, odd_scale = scale
            energies[which] = np.sqrt(
                np.square(even_scale * (even - mean * sums)) + np.square(odd_scale * odd)
            )
    return [energies[index] for index in range(count)]


def _filtered(image: Plane, row: Plane, column: Plane) -> Plane:
    if not row.any() or not column.any():
        return np.zeros_like(image)
    return cv2.sepFilter2D(image, -1, row, column, borderType=BORDER_REPEATED)


def _gradient(image: Plane) -> tuple[Plane, Plane]:
    across, down = (
        cv2.Scharr(image, -1, *order, scale=1.0 / 32.0, borderType=BORDER_REPEATED)
        for order in ((1, 0), (0, 1))
    )
    return across, down


def _window(plane: Plane) -> Plane:
    return cv2.GaussianBlur(plane, (0, 0), WINDOW_DEVIATION, borderType=cv2.BORDER_CONSTANT)


def _box(planes: Plane) -> Plane:
    """Average over a window of 10 x 10 pixels; half the resolution is enough for so wide a window."""
    half = len(planes) // 2
    coarse = cv2.resize(planes, (half, half), interpolation=cv2.INTER_AREA)
    return cv2.boxFilter(coarse, -1, (5, 5), borderType=cv2.BORDER_CONSTANT)


def _cast_votes(
    positions: NDArray[np.int64], steps: Plane, votes: tuple[Plane, Plane], shape: tuple[int, ...]
) -> list[Plane]:
    """Return the sums of votes for points a step ahead of `positions` minus points a step behind, as absolute values."""
    # The margin takes votes for points outside the image.
    margin = int(np.ceil(np.abs(steps).max(initial=0.0))) + 1
    rows, columns = shape[0] + 2 * margin, shape[1] + 2 * margin
    indices, shares = [], []
    for sign in (1, -1):
        target = positions + sign * steps
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
