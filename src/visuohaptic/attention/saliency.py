"""Saliency maps of single views after Itti, Koch & Niebur 1998.

Centre minus surround is computed for every feature plane and pair of pyramid levels. The operator N weakens maps with
several similar peaks. The maps of a channel are summed, and N on the sum gives the conspicuity map of the channel. The
saliency map is the weighted sum of conspicuity maps.
"""

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

# Before N a map is divided by its maximum, but by no less than this: fainter maps stay below 1. Unit: that of the
# feature plane.
FAINT_PEAK = 0.01
# Subtracted from centre minus surround, because smaller differences are rounding. A step of one of 256 grey levels is
# forty times as large. Unit: that of the feature plane.
NOISE = np.float32(1e-4)
# In the mean of local maxima, the weight of a maximum is 0 up to the height LOWEST_MAXIMUM and rises linearly to 1 over
# the next VOTE_RAMP. Walther & Koch's toolbox has a threshold of a tenth of the map's range instead.
LOWEST_MAXIMUM, VOTE_RAMP = np.float32(0.05), 0.1
# Smallest factor that N multiplies a map by. Maps without an outstanding peak, such as a long even edge, have it.
SMALLEST_FACTOR = 1e-3
# A pixel counts partly as a local maximum if its highest neighbour is higher by less than this fraction of the map's
# maximum.
PEAK_TOLERANCE = 1e-3
# Coefficients and standard deviations, as fractions of the map's rows, of the two Gaussians of the iterative operator.
# The constant inhibition is a fraction of the map's maximum (Itti & Koch 2000).
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

    The centre-surround maps of a channel are each scaled to the maximum 1, passed through the operator N, and summed.
    Maps with a maximum below `FAINT_PEAK` stay below 1. The sum is scaled to the maximum 1 and passed through N again.
    It is then multiplied by the largest value that the first N left in any of the channel's maps.

    Parameters
    ----------
    view : WorkingView
        The view on the working image, from `prepare_view`.
    channels : tuple of str
        Names of `CHANNELS`. The channels' weights are not used.
    parameters : AttentionParameters
        `normalisation` is the operator N.

    Returns
    -------
    dict of str to ndarray of shape (MAP_SIZE, MAP_SIZE), float32
        One map per channel, at least 0, on the square working image at half its resolution. With `normalisation`
        ``local_maxima`` or ``none`` the values are at most 1. With ``local_maxima`` one clear peak has about 1, and
        several equal peaks have much less. With ``iterative`` values may exceed 1.

    Raises
    ------
    AttentionError
        If a channel is unknown, or its `planes` returns another number of planes than its `count` says.
    """
    coarsest = max(CENTRE_LEVELS) + max(SURROUND_OFFSETS)
    certainties = build_pyramid(view.certainty, coarsest)
    pairs = _level_pairs(certainties)
    maps = {name: np.zeros((MAP_SIZE, MAP_SIZE), np.float32) for name in channels}
    window = _window(certainties, parameters)
    totals = {name: plane[window] for name, plane in maps.items()}
    strongest = dict.fromkeys(channels, 0.0)
    for name, level, pyramid in _pyramids(view, channels, parameters):
        total, peak = _sum_promoted(name, pyramid, pairs[level], window, parameters)
        totals[name] += total
        strongest[name] = max(strongest[name], peak)
    # Itti, Koch & Niebur 1998 scale the sum of each channel to full range before the last N, which also raises
    # channels without an outstanding peak. Here a channel is as conspicuous as its strongest map.
    for name, total in totals.items():
        total[:] = promote(_scaled(total), parameters) * np.float32(strongest[name])
    return maps


def saliency_map(maps: Mapping[str, Plane], parameters: AttentionParameters) -> Plane:
    """Compute the sum of conspicuity maps, each multiplied by the weight of its channel.

    `maps` is the result of `conspicuity_maps`, and the weights are `parameters.weights`. Channels without a map add
    nothing. The sum (MAP_SIZE, MAP_SIZE), float32, is not scaled to a maximum of 1.
    """
    weights = parameters.weights.model_dump()
    total = np.zeros((MAP_SIZE, MAP_SIZE), dtype=np.float32)
    for name in CHANNELS:
        if name in maps:
            total += np.float32(weights[name]) * maps[name]
    return total


def resample_to_view(
    plane: Plane, mask: NDArray[np.bool_], interpolation: int = cv2.INTER_LINEAR
) -> Plane:
    """Resample a map (MAP_SIZE, MAP_SIZE) to the pixels of a view with the mask (h, w); return (h, w), at least 0.

    The square map covers the view's longer edge. In a view that is not square it is cropped, not stretched, as
    `prepare_view` pads such views. The background is set to 0.
    """
    rows, columns = mask.shape
    side = max(rows, columns)
    large = _rectified(cv2.resize(plane, (side, side), interpolation=interpolation))
    top, left = (side - rows) // 2, (side - columns) // 2
    shown = np.ascontiguousarray(large[top : top + rows, left : left + columns])
    return cv2.copyTo(shown, mask.view(np.uint8))


def promote(plane: Plane, parameters: AttentionParameters) -> Plane:
    """Apply the operator N of `parameters.normalisation` to a map (n, n) with values from 0 to 1.

    The result has the shape of the map and is at least 0. For ``none`` it is `plane` itself, not a copy.
    """
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
    """Yield (channel, centre level, pyramid whose first level is this centre) per plane and centre level."""
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
    """Return the feature planes of a channel, multiplied by the certainty; raise if their number is wrong."""
    entry = CHANNELS[name]
    planes = entry.planes(view, parameters) if entry.planes else []
    if len(planes) != entry.count:
        raise AttentionError(
            f"channel {name} gave {len(planes)} planes; its entry says {entry.count}."
        )
    return planes


@dataclass(frozen=True)
class _LevelPair:
    """A centre level and a surround level `offset` levels coarser, with planes of the centre level's size."""

    offset: int
    inverse_centre: Plane  # 1 / certainty of the centre; 0 at empty pixels
    inverse_surround: Plane  # 1 / certainty of the surround; 0 at empty pixels
    support: Plane  # product of both certainties


def _window(certainties: list[Plane], parameters: AttentionParameters) -> tuple[slice, slice]:
    """Return the rows and columns of the maps that N needs: the object plus one pixel; for ``iterative`` all."""
    if parameters.normalisation == "iterative":
        # Filters of the iterative N spread values beyond the object, and later rounds carry them back.
        return slice(None), slice(None)
    cover = sum(_at_map_size(certainties[level]) for level in CENTRE_LEVELS)
    left, top, width, height = cv2.boundingRect(np.ceil(cover).astype(np.uint8))
    return slice(max(top - 1, 0), top + height + 1), slice(max(left - 1, 0), left + width + 1)


def _level_pairs(certainties: list[Plane]) -> dict[int, list[_LevelPair]]:
    """Return the pairs of levels per centre level, one per `SURROUND_OFFSETS`."""
    pairs: dict[int, list[_LevelPair]] = {}
    for level in CENTRE_LEVELS:
        centre = certainties[level]
        pairs[level] = []
        for offset in SURROUND_OFFSETS:
            surround = enlarge(certainties[level + offset], len(centre))
            planes = (reciprocal(centre), reciprocal(surround), centre * surround)
            pairs[level].append(_LevelPair(offset, *planes))
    return pairs


def _sum_promoted(
    name: str,
    pyramid: list[Plane],
    pairs: list[_LevelPair],
    window: tuple[slice, slice],
    parameters: AttentionParameters,
) -> tuple[Plane, float]:
    """Return the sum of a plane's centre-surround maps after N, and the largest value in any of them after N."""
    # The presence of a feature stands out, its absence does not (search asymmetry, Treisman & Gormley 1988). So
    # most channels count only centres with more than their surround. Colour and intensity also count centres with
    # less, in a second map: a red spot among green spots must not compete with them for the peak.
    total = np.zeros((MAP_SIZE, MAP_SIZE), dtype=np.float32)[window]
    strongest = 0.0
    # All pairs of a centre level have the same centre.
    centre = pyramid[0] * pairs[0].inverse_centre
    for pair in pairs:
        difference = _difference(centre, pyramid[pair.offset], pair)[window]
        sides = [difference, -difference] if CHANNELS[name].two_sided else [difference]
        for side in sides:
            promoted = promote(_scaled(_rectified(side - NOISE)), parameters)
            total += promoted
            strongest = max(strongest, _peak(promoted))
    return total, strongest


def _difference(centre: Plane, surround: Plane, pair: _LevelPair) -> Plane:
    """Compute centre minus surround, signed, times the support, at map size; only the centre is a mean already."""
    difference = enlarge(surround, len(centre)) * pair.inverse_surround
    np.subtract(centre, difference, out=difference)
    difference *= pair.support
    return _at_map_size(difference)


def _at_map_size(plane: Plane) -> Plane:
    """Halve or enlarge a square plane to (MAP_SIZE, MAP_SIZE)."""
    for _ in range((len(plane) // (MAP_SIZE + 1)).bit_length()):
        plane = reduce(plane)
    return enlarge(plane, MAP_SIZE)


def _peak(plane: Plane) -> float:
    """Return the maximum, at least 0."""
    return float(np.maximum.reduce(plane, axis=None, initial=0.0))


def _rectified(plane: Plane) -> Plane:
    """Set negative values to 0."""
    return cv2.threshold(plane, 0.0, 0.0, cv2.THRESH_TOZERO)[1]


def _scaled(plane: Plane) -> Plane:
    """Divide by the maximum, or by `FAINT_PEAK` if the maximum is lower."""
    return plane * (np.float32(1.0) / max(np.float32(_peak(plane)), np.float32(FAINT_PEAK)))


def _promote_by_local_maxima(plane: Plane) -> Plane:
    """Multiply by (maximum - mean of the other local maxima)², at least `SMALLEST_FACTOR` (Itti et al. 1998)."""
    # Each local maximum has a vote from 0 to 1 in the mean. The vote changes continuously with the maximum's height and
    # its rise above the neighbours, and equally high neighbours divide one vote. A threshold would let rounding decide
    # whether a symmetric object has one peak or two.
    below = cv2.dilate(plane, _NEIGHBOURS)
    below -= plane
    below *= np.float32(1.0 / PEAK_TOLERANCE)
    topmost = _rectified(np.subtract(np.float32(1.0), below, out=below))
    crowd = cv2.boxFilter(topmost, -1, (3, 3), normalize=False, borderType=cv2.BORDER_CONSTANT)
    voters = np.flatnonzero((topmost > 0.0) & (plane > LOWEST_MAXIMUM))
    heights, tops, crowds = plane.take(voters), topmost.take(voters), crowd.take(voters)
    level = np.minimum((heights - LOWEST_MAXIMUM) * np.float32(1.0 / VOTE_RAMP), np.float32(1.0))
    votes = tops / np.maximum(crowds, np.float32(1.0)) * level
    count, total = _sum_in_order(votes), _sum_in_order(votes * heights)
    largest = _peak(plane)
    mean_of_others = max(total - largest, 0.0) / max(count - 1.0, 1.0)
    return cv2.multiply(plane, max((largest - mean_of_others) ** 2, SMALLEST_FACTOR))


def _sum_in_order(values: Plane) -> float:
    """Sum in row order in float64; the order of OpenCV's and NumPy's sums depends on the processor."""
    return float(np.cumsum(values, dtype=np.float64)[-1]) if len(values) else 0.0


def _promote_iteratively(plane: Plane) -> Plane:
    """Add excitation minus inhibition and set negative values to 0, `ITERATIONS` times (Itti & Koch 2000)."""
    # The maximum may grow above 1.
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
    """Return the one-dimensional kernels, of sum 1, of excitation and inhibition for maps with `size` rows."""
    kernels = []
    for width in (EXCITATION_WIDTH, INHIBITION_WIDTH):
        deviation = width * size
        reach = min(int(3.0 * deviation + 0.5), size - 1)
        steps = np.arange(-reach, reach + 1)
        kernel = np.exp(-(steps**2) / (2.0 * deviation**2))
        kernels.append(plain_kernel(kernel / kernel.sum()))
    return kernels[0], kernels[1]
