"""From channels to one saliency map: centre-surround differences, the operator N, the sum."""

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
from .pyramid import (
    enlarge,
    reciprocal,
    reduce,
    reductions,
)
from .registry import CHANNELS, channel

MAP_SIZE = WORKING_SIZE // 2
# Largest response, in the channel's full scale, below which a map is not scaled up further.
FAINT = 0.01
# Differences that rounding may cause; one of 256 grey levels is forty times as large.
NOISE = np.float32(1e-4)
# Maxima count from about a tenth of the range on, as in the toolbox of Walther & Koch.
LOWEST_MAXIMUM, COUNTED_RANGE = np.float32(0.05), 0.1
# Least factor of N, for a map in which nothing stands out, such as one long even edge.
REMNANT = 1e-3
# A pixel this far below its highest neighbour is still part of the same peak.
PLATEAU = 1e-3
EXCITATION, EXCITATION_WIDTH = 0.5, 0.02
INHIBITION, INHIBITION_WIDTH = 1.5, 0.25
CONSTANT_INHIBITION = 0.02
# Rounds of the iterative operator, as in the toolbox of Walther & Koch; ten leave little but the strongest peak.
ITERATIONS = 3

_NEIGHBOURS = np.ones((3, 3), dtype=np.uint8)


def conspicuity_maps(
    view: WorkingView, channels: tuple[str, ...], parameters: AttentionParameters
) -> dict[str, Plane]:
    """Compute the conspicuity maps (MAP_SIZE, MAP_SIZE), float32, of some channels; 1 is a single peak."""
    deepest = max(CENTRE_LEVELS) + max(SURROUND_OFFSETS)
    certainties = reductions(view.certainty, deepest)
    scales = _scales(certainties)
    maps = {name: np.zeros((MAP_SIZE, MAP_SIZE), np.float32) for name in channels}
    window = _window(certainties, parameters)
    totals = {name: plane[window] for name, plane in maps.items()}
    strongest = dict.fromkeys(channels, 0.0)
    for name, level, pyramid in _pyramids(view, channels, parameters):
        total, peak = _promoted(name, pyramid, scales[level], window, parameters)
        totals[name] += total
        strongest[name] = max(strongest[name], peak)
    # Itti, Koch & Niebur scale every channel's sum to full range before the last N, so a channel in
    # which nothing stands out still counts; here it is as conspicuous as its strongest map.
    for name, total in totals.items():
        total[:] = promote(_scaled(total), parameters) * np.float32(strongest[name])
    return maps


def saliency_map(maps: Mapping[str, Plane], parameters: AttentionParameters) -> Plane:
    """Add conspicuity maps by the channels' weights; the sum is not scaled."""
    weights = parameters.weights.model_dump()
    total = np.zeros((MAP_SIZE, MAP_SIZE), dtype=np.float32)
    for name in CHANNELS:
        if name in maps:
            total += np.float32(weights[name]) * maps[name]
    return total


def on_view(plane: Plane, mask: NDArray[np.bool_], interpolation: int = cv2.INTER_LINEAR) -> Plane:
    """Resample a map (MAP_SIZE, MAP_SIZE) to the pixels (h, w) of its view, and set the background to zero."""
    rows, columns = mask.shape
    side = max(rows, columns)
    large = _rectified(cv2.resize(plane, (side, side), interpolation=interpolation))
    top, left = (side - rows) // 2, (side - columns) // 2
    shown = np.ascontiguousarray(large[top : top + rows, left : left + columns])
    return cv2.copyTo(shown, mask.view(np.uint8))


def promote(plane: Plane, parameters: AttentionParameters) -> Plane:
    """Apply the operator N to a map, from 0 to a largest value of 1 or less."""
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
    """Give each plane of some channels on each centre level and the coarser ones, with channel and level."""
    steps = max(SURROUND_OFFSETS)
    coarsest = max(CENTRE_LEVELS) + steps
    for entry in [channel(name) for name in channels]:
        if entry.stacks:
            stacks = entry.stacks(view, parameters)
            for level, planes in zip(CENTRE_LEVELS, stacks, strict=False):
                yield from ((entry.name, level, reductions(plane, steps)) for plane in planes)
            continue
        pyramids = [reductions(plane, coarsest) for plane in _planes(entry.name, view, parameters)]
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
    """One pair of scales: levels from centre to surround, and factors from their certainties."""

    offset: int
    centre_mean: Plane
    surround_mean: Plane
    support: Plane


def _window(certainties: list[Plane], parameters: AttentionParameters) -> tuple[slice, slice]:
    """Give the rows and columns of the object in the maps, and one more around for N."""
    if parameters.normalisation == "iterative":
        # What it spreads beyond the object comes back in later rounds.
        return slice(None), slice(None)
    seen = sum(_at_map_size(certainties[level]) for level in CENTRE_LEVELS)
    left, top, width, height = cv2.boundingRect(np.ceil(seen).astype(np.uint8))
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
    """Add up the promoted maps of a plane, and give the largest value of any."""
    # Presence of a feature stands out, absence does not (search asymmetry, Treisman & Gormley 1988):
    # most channels count only where the centre has more than the surround. Colour and intensity have
    # two sides, and each is a map of its own, as a red spot among green ones is alone on its side.
    total = np.zeros((MAP_SIZE, MAP_SIZE), dtype=np.float32)[window]
    strongest = 0.0
    # Every scale has the same centre.
    centre = pyramid[0] * scales[0].centre_mean
    for scale in scales:
        difference = _difference(centre, pyramid[scale.offset], scale)[window]
        sides = [difference, -difference] if CHANNELS[name].two_sided else [difference]
        for side in sides:
            promoted = promote(_scaled(_rectified(side - NOISE)), parameters)
            total += promoted
            strongest = max(strongest, _peak(promoted))
    return total, strongest


def _difference(centre: Plane, coarse: Plane, scale: _Scale) -> Plane:
    difference = enlarge(coarse, len(centre)) * scale.surround_mean
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
    """Apply Itti, Koch & Niebur 1998: times (M - mean of the other local maxima) squared."""
    # Which pixel is a maximum, and whether it is high enough to count, change gradually over a small
    # range, and a peak between pixels counts once: on a symmetric object rounding would otherwise
    # decide between one peak and two.
    below = cv2.dilate(plane, _NEIGHBOURS)
    below -= plane
    below *= np.float32(1.0 / PLATEAU)
    topmost = _rectified(np.subtract(np.float32(1.0), below, out=below))
    crowd = cv2.boxFilter(topmost, -1, (3, 3), normalize=False, borderType=cv2.BORDER_CONSTANT)
    # All other pixels have no vote.
    voters = np.flatnonzero((topmost > 0.0) & (plane > LOWEST_MAXIMUM))
    heights, tops, crowds = (one.take(voters) for one in (plane, topmost, crowd))
    level = np.minimum(
        (heights - LOWEST_MAXIMUM) * np.float32(1.0 / COUNTED_RANGE), np.float32(1.0)
    )
    votes = tops / np.maximum(crowds, np.float32(1.0)) * level
    count, total = _sum_in_order(votes), _sum_in_order(votes * heights)
    largest = _peak(plane)
    others = max(total - largest, 0.0) / max(count - 1.0, 1.0)
    return cv2.multiply(plane, max((largest - others) ** 2, REMNANT))


def _sum_in_order(values: Plane) -> float:
    """Sum one after the other, in float64: OpenCV's and NumPy's own order hangs on the processor's instructions."""
    return float(np.cumsum(values, dtype=np.float64)[-1]) if len(values) else 0.0


def _promote_iteratively(plane: Plane) -> Plane:
    """Itti & Koch 2000: differences of Gaussians, rectified, in several rounds."""
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
