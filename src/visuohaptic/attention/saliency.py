"""From channels to one saliency map: centre-surround differences, the operator N, the sum."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

import cv2
import numpy as np
from numpy.typing import NDArray

from visuohaptic.attention.channels import WorkingView, channel_planes
from visuohaptic.attention.parameters import CHANNELS, AttentionParameters
from visuohaptic.attention.pyramid import (
    WORKING_SIZE,
    Plane,
    enlarge,
    from_map_size,
    reciprocal,
    reduce,
    reductions,
)

MAP_SIZE = WORKING_SIZE // 2
TWO_SIDED_CHANNELS = ("colour", "intensity")
# Largest response, in a channel's own unit of full scale, below which a map is not blown up.
FAINT = 0.01
# Maxima below this share of the range are not counted, as in the toolbox of Walther & Koch.
COUNTED_MAXIMA = 0.1
EXCITATION, EXCITATION_WIDTH = 0.5, 0.02
INHIBITION, INHIBITION_WIDTH = 1.5, 0.25
CONSTANT_INHIBITION = 0.02
ITERATIONS = 3

_NEIGHBOURS = np.ones((3, 3), dtype=np.uint8)


def conspicuity_maps(
    view: WorkingView, channels: tuple[str, ...], parameters: AttentionParameters
) -> dict[str, Plane]:
    """Compute the conspicuity map of each of some channels.

    Parameters
    ----------
    view : WorkingView
        The view.
    channels : tuple of str
        Which, out of `parameters.CHANNELS`.
    parameters : AttentionParameters
        Scales and the operator N.

    Returns
    -------
    dict of str to numpy.ndarray
        Shape (MAP_SIZE, MAP_SIZE) each, float32, at least 0, in the order of
        the channels. A map of 1 somewhere has a single peak.
    """
    scales = _scales(view.certainty, parameters)
    return {
        name: _conspicuity(_responses(name, view, scales, parameters), parameters)
        for name in CHANNELS
        if name in channels
    }


def saliency_map(maps: Mapping[str, Plane], parameters: AttentionParameters) -> Plane:
    """Add conspicuity maps by the channels' weights.

    Parameters
    ----------
    maps : mapping of str to numpy.ndarray
        Conspicuity maps of one shape.
    parameters : AttentionParameters
        The weights.

    Returns
    -------
    numpy.ndarray
        Their weighted sum, float32, not scaled.
    """
    weights = parameters.weights.model_dump()
    total = np.zeros((MAP_SIZE, MAP_SIZE), dtype=np.float32)
    for name in CHANNELS:
        if name in maps:
            total += np.float32(weights[name]) * maps[name]
    return total


def view_sized(
    plane: Plane, mask: NDArray[np.bool_], *, peak: float | None = None
) -> NDArray[np.float32]:
    """Bring a map onto the pixels of its view and clear the background.

    Parameters
    ----------
    plane : numpy.ndarray
        Shape (MAP_SIZE, MAP_SIZE), float32.
    mask : numpy.ndarray
        Shape (h, w), bool: where the object is.
    peak : float, optional
        Value that the largest pixel shall have; as it is where left out.

    Returns
    -------
    numpy.ndarray
        Shape (h, w), float32, at least 0; all zeros stay so.
    """
    large = from_map_size(plane, (mask.shape[0], mask.shape[1])) * mask
    top = float(large.max(initial=0.0))
    if peak is None or top <= 0.0:
        return large
    return large * np.float32(peak / top)


def promote(plane: Plane, method: str) -> Plane:
    """Apply the operator N: few strong peaks are promoted over many alike.

    Parameters
    ----------
    plane : numpy.ndarray
        Shape (n, n), float32, at least 0, scaled to a largest value of 1 or less.
    method : str
        ``local_maxima``, ``iterative`` or ``none``.

    Returns
    -------
    numpy.ndarray
        Shape (n, n), at least 0.
    """
    return OPERATORS[method](plane)


@dataclass(frozen=True)
class _Scale:
    """One pair of scales: level of the centre, steps to the surround, and what is certain there."""

    level: int
    offset: int
    centre_mean: Plane
    surround_mean: Plane
    support: Plane


def _scales(certainty: Plane, parameters: AttentionParameters) -> list[_Scale]:
    deepest = max(parameters.centre_levels) + max(parameters.surround_offsets)
    certainties = reductions(certainty, deepest)
    scales = []
    for level in parameters.centre_levels:
        centre = certainties[level]
        for offset in parameters.surround_offsets:
            surround = enlarge(certainties[level + offset], len(centre))
            scales.append(
                _Scale(level, offset, reciprocal(centre), reciprocal(surround), centre * surround)
            )
    return scales


def _conspicuity(responses: list[Plane], parameters: AttentionParameters) -> Plane:
    promoted = [promote(_scaled(response), parameters.normalisation) for response in responses]
    strongest = max(float(plane.max()) for plane in promoted)
    total = sum(promoted[1:], promoted[0])
    return np.float32(strongest) * promote(_scaled(total), parameters.normalisation)


def _responses(
    name: str, view: WorkingView, scales: list[_Scale], parameters: AttentionParameters
) -> list[Plane]:
    """Give centre less surround for each plane and pair of scales, at the map's size.

    What is there stands out, what is lacking does not (search asymmetry,
    Treisman & Gormley 1988): measures of how much goes on count where the centre
    has more of it. Colour and intensity have two sides, such as red and green,
    and each side is a map of its own (on-centre and off-centre cells), as a red
    spot among green ones is alone on its side.
    """
    centres = channel_planes(name, view, parameters)
    steps = max(parameters.surround_offsets)
    pyramids = {
        level: [reductions(plane, steps) for plane in planes] for level, planes in centres.items()
    }
    differences = [
        _difference(pyramid, scale) for scale in scales for pyramid in pyramids[scale.level]
    ]
    sides = (1.0, -1.0) if name in TWO_SIDED_CHANNELS else (1.0,)
    return [
        np.maximum(np.float32(side) * difference, np.float32(0.0))
        for difference in differences
        for side in sides
    ]


def _difference(pyramid: list[Plane], scale: _Scale) -> Plane:
    centre = pyramid[0] * scale.centre_mean
    surround = enlarge(pyramid[scale.offset], len(centre)) * scale.surround_mean
    return _at_map_size((centre - surround) * scale.support)


def _at_map_size(plane: Plane) -> Plane:
    while len(plane) > MAP_SIZE:
        plane = reduce(plane)
    return enlarge(plane, MAP_SIZE)


def _scaled(plane: Plane) -> Plane:
    return plane / np.float32(max(float(plane.max()), FAINT))


def _promote_by_local_maxima(plane: Plane) -> Plane:
    """Itti, Koch & Niebur 1998: times (M - mean of the other local maxima) squared."""
    peaks = plane[
        (plane == cv2.dilate(plane, _NEIGHBOURS, borderType=cv2.BORDER_CONSTANT, borderValue=0))
        & (plane > COUNTED_MAXIMA)
    ]
    largest = float(plane.max())
    others = (float(peaks.sum()) - largest) / (len(peaks) - 1) if len(peaks) > 1 else 0.0
    return plane * np.float32((largest - others) ** 2)


def _promote_iteratively(plane: Plane) -> Plane:
    """Itti & Koch 2000: differences of Gaussians, rectified, three times over."""
    excitation, inhibition = _gaussians(len(plane))
    support = cv2.sepFilter2D(
        np.ones_like(plane), -1, inhibition, inhibition, borderType=cv2.BORDER_CONSTANT
    )
    for _ in range(ITERATIONS):
        near = cv2.sepFilter2D(plane, -1, excitation, excitation, borderType=cv2.BORDER_CONSTANT)
        far = cv2.sepFilter2D(plane, -1, inhibition, inhibition, borderType=cv2.BORDER_CONSTANT)
        change = np.float32(EXCITATION**2) * near - np.float32(INHIBITION**2) * far / support
        plane = np.maximum(plane + change - CONSTANT_INHIBITION * float(plane.max()), 0.0)
    return plane


def _leave(plane: Plane) -> Plane:
    return plane


@cache
def _gaussians(size: int) -> tuple[Plane, Plane]:
    kernels = []
    for width in (EXCITATION_WIDTH, INHIBITION_WIDTH):
        deviation = width * size
        reach = min(int(3.0 * deviation + 0.5), size - 1)
        steps = np.arange(-reach, reach + 1)
        kernel = np.exp(-(steps**2) / (2.0 * deviation**2))
        kernels.append((kernel / kernel.sum()).astype(np.float32))
    return kernels[0], kernels[1]


OPERATORS: Mapping[str, Callable[[Plane], Plane]] = MappingProxyType(
    {
        "local_maxima": _promote_by_local_maxima,
        "iterative": _promote_iteratively,
        "none": _leave,
    }
)
