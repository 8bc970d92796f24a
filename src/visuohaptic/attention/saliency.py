"""From channels to a saliency map: centre-surround differences, the operator N, the weighted sum."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from .channels import WorkingView
from .errors import AttentionError
from .levels import CENTRE_LEVELS, SURROUND_OFFSETS, WORKING_SIZE
from .parameters import AttentionParameters
from .plain_filters import plain_kernel
from .planes import Plane
from .pyramid import build_pyramid, enlarge, reciprocal, reduce
from .registry import CHANNELS, channel

MAP_SIZE = WORKING_SIZE // 2
"""Rows and columns of conspicuity and saliency maps."""

# Maps are scaled to a peak of 1. A map with a lower peak than this, of the channel's full scale, is scaled by 1 / FAINT.
FAINT = 0.01
# Smaller differences are rounding; a step of one of 256 grey levels is forty times as large.
NOISE = np.float32(1e-4)
# Votes of local maxima rise from 0 at the lowest maximum to 1 over the counted range. Walther & Koch's toolbox has
# a threshold of a tenth of the range instead.
LOWEST_MAXIMUM, COUNTED_RANGE = np.float32(0.05), 0.1
# Least factor of N, for maps without an outstanding peak, such as a long even edge.
REMNANT = 1e-3
# A pixel that is lower than its highest neighbour by less than this belongs to the same peak.
PLATEAU = 1e-3
# Strengths of the iterative operator, and widths as fractions of the map (Itti & Koch 2000).
EXCITATION, EXCITATION_WIDTH = 0.5, 0.02
INHIBITION, INHIBITION_WIDTH = 1.5, 0.25
CONSTANT_INHIBITION = 0.02
# Rounds of the iterative operator, as in the toolbox of Walther & Koch; ten leave little but the strongest peak.
ITERATIONS = 3

_NEIGHBOURS = np.ones((3, 3), dtype=np.uint8)


def conspicuity_maps(
    view: WorkingView, channels: tuple[str, ...], parameters: AttentionParameters
) -> dict[str, Plane]:
    """Compute the conspicuity maps of channels.

    Parameters
    ----------
    view : WorkingView
        The view.
    channels : tuple of str
        Names of channels.
    parameters : AttentionParameters
        The model's parameters.

    Returns
    -------
    dict of str to ndarray of shape (MAP_SIZE, MAP_SIZE), float32
        A map per channel, at least 0. A channel with a single peak has the maximum 1.
    """
    coarsest = max(CENTRE_LEVELS) + max(SURROUND_OFFSETS)
    certainties = build_pyramid(view.certainty, coarsest)
    scales = _scales(certainties)
    maps = {name: np.zeros((MAP_SIZE, MAP_SIZE), np.float32) for name in channels}
    window = _window(certainties, parameters)
    totals = {name: plane[window] for name, plane in maps.items()}
    strongest = dict.fromkeys(channels, 0.0)
    for name, level, pyramid in _pyramids(view, channels, parameters):
        total, peak = _promoted(name, pyramid, scales[level], window, parameters)
        totals[name] += total
        strongest[name] = max(strongest[name], peak)
    # Itti, Koch & Niebur 1998 scale the sum of each channel to full range before the last N, which also raises
    # channels without an outstanding peak. Here a channel is as conspicuous as its strongest map.
    for name, total in totals.items():
        total[:] = promote(_scaled(total), parameters) * np.float32(strongest[name])
    return maps


def saliency_map(maps: Mapping[str, Plane], parameters: AttentionParameters) -> Plane:
    """Return the weighted sum of conspicuity maps (MAP_SIZE, MAP_SIZE), float32, by channel; it is not scaled."""
    weights = parameters.weights.model_dump()
    total = np.zeros((MAP_SIZE, MAP_SIZE), dtype=np.float32)
    for name in CHANNELS:
        if name in maps:
            total += np.float32(weights[name]) * maps[name]
    return total


def on_view(plane: Plane, mask: NDArray[np.bool_], interpolation: int = cv2.INTER_LINEAR) -> Plane:
    """Resample a map (MAP_SIZE, MAP_SIZE) to the pixels (h, w) of a view, and set the background to zero."""
    rows, columns = mask.shape
    side = max(rows, columns)
    large = _rectified(cv2.resize(plane, (side, side), interpolation=interpolation))
    top, left = (side - rows) // 2, (side - columns) // 2
    shown = np.ascontiguousarray(large[top : top + rows, left : left + columns])
    return cv2.copyTo(shown, mask.view(np.uint8))


def promote(plane: Plane, parameters: AttentionParameters) -> Plane:
    """Apply the operator N to a map with values from 0 to at most 1."""
    match parameters.normalisation:
        case "local_maxima":
            return _promote_by_local_maxima(plane)
        case "iterative":
            return _promote_iteratively(plane)
        case "none":
            return plane


def _pyramids(
    view: WorkingView, channels: Sequence[str], parameters: AttentionParameters
) -> Iterator[tuple[str, int, list[Plane]]]:
    """Yield channel, centre level, and a pyramid from that level on, for every plane of the channels."""
    steps = max(SURROUND_OFFSETS)
    coarsest = max(CENTRE_LEVELS) + steps
    for entry in [channel(name) for name in channels]:
        if entry.stacks:
            stacks = entry.stacks(view, parameters)
            for level, planes in zip(CENTRE_LEVELS, stacks, strict=False):
                yield from ((entry.name, level, build_pyramid(plane, steps)) for plane in planes)
            continue
        planes = _planes(entry.name, view, parameters)
        pyramids = [build_pyramid(plane, coarsest) for plane in planes]
        for level in CENTRE_LEVELS:
            yield from ((entry.name, level, pyramid[level:]) for pyramid in pyramids)


def _planes(name: str, view: WorkingView, parameters: AttentionParameters) -> list[Plane]:
    entry = CHANNELS[name]
    planes = entry.planes(view, parameters) if entry.planes else []
    if len(planes) != entry.count:
        raise AttentionError(
            f"channel {name} gave {len(planes)} planes; its entry says {entry.count}."
        )
    return planes


@dataclass(frozen=True)
class _Scale:
    """A pair of scales: levels from centre to surround, and factors from the certainties of both."""

    offset: int
    centre_mean: Plane
    surround_mean: Plane
    support: Plane


def _window(certainties: list[Plane], parameters: AttentionParameters) -> tuple[slice, slice]:
    """Return the rows and columns of the object in the maps, with a margin of a pixel for N."""
    if parameters.normalisation == "iterative":
        # Its filters spread values beyond the object, which later rounds carry back.
        return slice(None), slice(None)
    cover = sum(_at_map_size(certainties[level]) for level in CENTRE_LEVELS)
    left, top, width, height = cv2.boundingRect(np.ceil(cover).astype(np.uint8))
    return slice(max(top - 1, 0), top + height + 1), slice(max(left - 1, 0), left + width + 1)


def _scales(certainties: list[Plane]) -> dict[int, list[_Scale]]:
    scales: dict[int, list[_Scale]] = {}
    for level in CENTRE_LEVELS:
        centre = certainties[level]
        scales[level] = []
        for offset in SURROUND_OFFSETS:
            surround = enlarge(certainties[level + offset], len(centre))
            planes = (reciprocal(centre), reciprocal(surround), centre * surround)
            scales[level].append(_Scale(offset, *planes))
    return scales


def _promoted(
    name: str,
    pyramid: list[Plane],
    scales: list[_Scale],
    window: tuple[slice, slice],
    parameters: AttentionParameters,
) -> tuple[Plane, float]:
    """Return the sum of the promoted maps of a plane, and the largest value in any of these maps."""
    # The presence of a feature stands out, its absence does not (search asymmetry, Treisman & Gormley 1988). So
    # most channels count only centres with more than their surround. Colour and intensity also count centres with
    # less, in a second map: a red spot among green spots must not compete with them for the peak.
    total = np.zeros((MAP_SIZE, MAP_SIZE), dtype=np.float32)[window]
    strongest = 0.0
    # All scales of a level have the same centre.
    centre = pyramid[0] * scales[0].centre_mean
    for scale in scales:
        difference = _difference(centre, pyramid[scale.offset], scale)[window]
        sides = [difference, -difference] if CHANNELS[name].two_sided else [difference]
        for side in sides:
            promoted = promote(_scaled(_rectified(side - NOISE)), parameters)
            total += promoted
            strongest = max(strongest, _peak(promoted))
    return total, strongest


def _difference(centre: Plane, surround: Plane, scale: _Scale) -> Plane:
    difference = enlarge(surround, len(centre)) * scale.surround_mean
    np.subtract(centre, difference, out=difference)
    difference *= scale.support
    return _at_map_size(difference)


def _at_map_size(plane: Plane) -> Plane:
    while len(plane) > MAP_SIZE:
        plane = reduce(plane)
    return enlarge(plane, MAP_SIZE)


def _peak(plane: Plane) -> float:
    return float(np.maximum.reduce(plane, axis=None, initial=0.0))


def _rectified(plane: Plane) -> Plane:
    return cv2.threshold(plane, 0.0, 0.0, cv2.THRESH_TOZERO)[1]


def _scaled(plane: Plane) -> Plane:
    return plane * (np.float32(1.0) / max(np.float32(_peak(plane)), np.float32(FAINT)))


def _promote_by_local_maxima(plane: Plane) -> Plane:
    """Multiply by the square of (maximum - mean of the other local maxima), as Itti, Koch & Niebur 1998 do."""
    # A pixel is a maximum, and high enough, by degrees; neighbouring pixels of one peak divide its vote. Otherwise
    # rounding would decide whether a symmetric object has one peak or two.
    below = cv2.dilate(plane, _NEIGHBOURS)
    below -= plane
    below *= np.float32(1.0 / PLATEAU)
    topmost = _rectified(np.subtract(np.float32(1.0), below, out=below))
    crowd = cv2.boxFilter(topmost, -1, (3, 3), normalize=False, borderType=cv2.BORDER_CONSTANT)
    voters = np.flatnonzero((topmost > 0.0) & (plane > LOWEST_MAXIMUM))
    heights, tops, crowds = plane.take(voters), topmost.take(voters), crowd.take(voters)
    level = np.minimum(
        (heights - LOWEST_MAXIMUM) * np.float32(1.0 / COUNTED_RANGE), np.float32(1.0)
    )
    votes = tops / np.maximum(crowds, np.float32(1.0)) * level
    count, total = _sum_in_order(votes), _sum_in_order(votes * heights)
    largest = _peak(plane)
    mean_of_others = max(total - largest, 0.0) / max(count - 1.0, 1.0)
    return cv2.multiply(plane, max((largest - mean_of_others) ** 2, REMNANT))


def _sum_in_order(values: Plane) -> float:
    """Sum in row order in float64; the order of OpenCV's and NumPy's sums depends on the processor."""
    return float(np.cumsum(values, dtype=np.float64)[-1]) if len(values) else 0.0


def _promote_iteratively(plane: Plane) -> Plane:
    """Add a difference of Gaussians and rectify, `ITERATIONS` times (Itti & Koch 2000)."""
    excitation, inhibition = _gaussians(len(plane))
    support = cv2.sepFilter2D(
        np.ones_like(plane), -1, inhibition, inhibition, borderType=cv2.BORDER_CONSTANT
    )
    for _ in range(ITERATIONS):
        near = cv2.sepFilter2D(plane, -1, excitation, excitation, borderType=cv2.BORDER_CONSTANT)
        far = cv2.sepFilter2D(plane, -1, inhibition, inhibition, borderType=cv2.BORDER_CONSTANT)
        change = np.float32(EXCITATION**2) * near - np.float32(INHIBITION**2) * far / support
        floor = np.float32(CONSTANT_INHIBITION) * np.float32(_peak(plane))
        plane = _rectified(plane + change - floor)
    return plane


@cache
def _gaussians(size: int) -> tuple[Plane, Plane]:
    kernels = []
    for width in (EXCITATION_WIDTH, INHIBITION_WIDTH):
        deviation = width * size
        reach = min(int(3.0 * deviation + 0.5), size - 1)
        steps = np.arange(-reach, reach + 1)
        kernel = np.exp(-(steps**2) / (2.0 * deviation**2))
        kernels.append(plain_kernel(kernel / kernel.sum()))
    return kernels[0], kernels[1]
