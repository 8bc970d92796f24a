"""The whole model: from views to saliency maps and fixations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from .channels import prepare_view
from .errors import AttentionError
from .parameters import AttentionParameters
from .plain_filters import plain_filters
from .planes import Plane
from .pyramid import filled
from .registry import CHANNELS, TERMS
from .saliency import conspicuity_maps, on_view, saliency_map
from .scanpath import Scanpath, scan
from .terms import SeenSurface, prepare_surface

SMALLEST_VIEW = 16
# Keeps a map of zeros from being divided by zero.
SMALLEST_PEAK = 1e-30


@dataclass(frozen=True)
class Attention:
    """Saliency and fixations of one view.

    `saliency` (h, w), float32, is 0 to 1, zero on the background; `conspicuity` holds, for each channel that
    ran, a map (h, w), float32, at least 0, before its weight, and `skipped` why the others did not run.
    """

    saliency: Plane
    conspicuity: dict[str, Plane]
    skipped: dict[str, str]
    scanpath: Scanpath


@plain_filters()
def attend(
    colour: Plane,
    mask: NDArray[np.bool_],
    point: NDArray[np.float64],
    normal: NDArray[np.float64],
    face: NDArray[np.int64],
    curvature: Plane,
    parameters: AttentionParameters,
    eye: NDArray[np.float64] | None = None,
    terms: Mapping[str, float] | None = None,
) -> list[Attention]:
    """Compute saliency and fixations for each of n views; each depends on its own view only.

    `colour` (n, h, w, 3), float32, is at least 0, of any scale; `mask` (n, h, w), bool, says where
    the object is. `point` and `normal` (n, h, w, 3), float64, are visible points of the surface and
    their unit normals, `face` (n, h, w), int64, their faces, and `curvature` (n, h, w), float32,
    the curvedness there, at least 0, per unit of the points. `eye` (n, 3), float64, is where the
    eye is, in the points' frame. `terms` are weights by names of `TERMS`: where one is not 0, the
    saliency map is the exponential of channels and terms together, and `eye` is needed.

    Raises `AttentionError` if shapes differ, a view is too small, a value is not finite or below
    its range, a term is unknown, or a term has a weight and no eye is given.
    """
    _check_views(colour, mask, point, normal, face, curvature)
    weights = _weights_of(terms or {})
    _check_eyes(eye, len(mask), weights)
    eyes = [None] * len(mask) if eye is None else eye
    views = zip(colour, mask, point, normal, face, curvature, eyes, strict=True)
    return [_attend_view(parameters, weights, *view) for view in views]


def reasons_to_skip(
    colour: Plane, mask: NDArray[np.bool_], curvature: Plane, parameters: AttentionParameters
) -> dict[str, str]:
    """Give the channels, in order, that a view as `prepare_view` takes it does not need, and why.

    Their maps would be zero, or their weights are: the saliency map is the same, bit for bit.
    """
    found = _dull_channels(colour, mask, curvature)
    weights = parameters.weights.model_dump()
    found |= {name: "its weight is 0" for name in CHANNELS if not weights.get(name)}
    return {name: found[name] for name in CHANNELS if name in found}


def term_planes(seen: SeenSurface, names: Iterable[str]) -> dict[str, Plane]:
    """Compute some terms, shape (n, n), float32 each, by name; zero off the object."""
    shown = seen.certainty > 0
    return {name: TERMS[name].plane(seen).astype(np.float32) * shown for name in names}


def _dull_channels(colour: Plane, mask: NDArray[np.bool_], curvature: Plane) -> dict[str, str]:
    if not mask.any():
        return dict.fromkeys(CHANNELS, "the view shows nothing of the object")
    inside = mask.view(np.uint8)
    missing: dict[str | None, str] = {}
    red, green, blue = cv2.split(np.ascontiguousarray(colour))
    if not np.any(((red != green) | (green != blue)) & mask):
        missing["hues"] = "every pixel is grey"
    if all(_is_uniform(hue, inside) for hue in (red, green, blue)):
        missing |= dict.fromkeys(("hues", "colours"), "every pixel has one and the same colour")
    if _is_uniform(np.ascontiguousarray(curvature), inside):
        missing["curvature"] = "the surface is curved alike everywhere"
    return {
        name: missing[entry.needs] for name, entry in CHANNELS.items() if entry.needs in missing
    }


def _is_uniform(plane: Plane, inside: NDArray[np.uint8]) -> bool:
    lowest, highest, _, _ = cv2.minMaxLoc(plane, inside)
    return lowest == highest


def _exponential(total: Plane, seen: SeenSurface, weights: Mapping[str, float]) -> Plane:
    """Give the exponential of channels and terms together, 1 at its largest; beyond the outline it goes on."""
    terms = np.zeros_like(seen.certainty)
    for name, plane in term_planes(seen, weights).items():
        terms += np.float32(weights[name]) * plane
    exponent = total + terms
    largest = float(exponent[seen.certainty > 0].max(initial=-np.inf))
    if not np.isfinite(largest):
        return np.zeros_like(total)
    value = cv2.exp(np.minimum(exponent - np.float32(largest), 0.0))
    return filled(value * seen.certainty, seen.certainty)


def _attend_view(
    parameters: AttentionParameters,
    terms: Mapping[str, float],
    colour: Plane,
    mask: NDArray[np.bool_],
    point: NDArray[np.float64],
    normal: NDArray[np.float64],
    face: NDArray[np.int64],
    curvature: Plane,
    eye: NDArray[np.float64] | None,
) -> Attention:
    skipped = reasons_to_skip(colour, mask, curvature, parameters)
    channels = tuple(name for name in CHANNELS if name not in skipped)
    maps = conspicuity_maps(prepare_view(colour, mask, curvature), channels, parameters)
    total = saliency_map(maps, parameters)
    if terms and eye is not None:
        total = _exponential(total, prepare_surface(mask, point, normal, eye), terms)
    saliency = on_view(total, mask, cv2.INTER_CUBIC)
    saliency /= np.float32(max(float(saliency.max()), SMALLEST_PEAK))
    return Attention(
        saliency,
        {name: on_view(plane, mask) for name, plane in maps.items()},
        skipped,
        scan(saliency, mask, point, normal, face, parameters),
    )


def _weights_of(terms: Mapping[str, float]) -> dict[str, float]:
    """Give the weights that are not 0, in the order of `TERMS`."""
    if unknown := sorted({*terms} - {*TERMS}):
        raise AttentionError(f"{unknown[0]!r} is no term; {', '.join(TERMS)} are allowed.")
    return {name: terms[name] for name in TERMS if terms.get(name)}


def _check_eyes(eye: NDArray[np.float64] | None, views: int, terms: Mapping[str, float]) -> None:
    if eye is None:
        if terms:
            raise AttentionError("a term has a weight and no eye is given; terms need the eye.")
    elif eye.shape != (views, 3) or not np.isfinite(eye).all():
        raise AttentionError(
            f"eye has shape {eye.shape}; {(views, 3)} of finite numbers is allowed."
        )


def _check_views(
    colour: Plane,
    mask: NDArray[np.bool_],
    point: NDArray[np.float64],
    normal: NDArray[np.float64],
    face: NDArray[np.int64],
    curvature: Plane,
) -> None:
    if mask.ndim != 3 or mask.dtype != np.bool_:
        raise AttentionError(
            f"mask has shape {mask.shape} and type {mask.dtype}; (n, h, w) of bool is allowed."
        )
    if min(mask.shape[1:]) < SMALLEST_VIEW:
        raise AttentionError(
            f"views are {mask.shape[1]} x {mask.shape[2]} pixels; "
            f"{SMALLEST_VIEW} x {SMALLEST_VIEW} is the least."
        )
    vector = (*mask.shape, 3)
    arrays: dict[str, tuple[NDArray[Any], tuple[int, ...]]] = {
        "colour": (colour, vector),
        "point": (point, vector),
        "normal": (normal, vector),
        "face": (face, mask.shape),
        "curvature": (curvature, mask.shape),
    }
    for name, (array, shape) in arrays.items():
        if array.shape != shape:
            raise AttentionError(f"{name} has shape {array.shape}; {shape} goes with the mask.")
        # The extremes are finite only if every value is; this is faster than a test of each.
        lowest, highest = array.min(initial=0), array.max(initial=0)
        if not (np.isfinite(lowest) and np.isfinite(highest)):
            raise AttentionError(f"{name} has values that are not finite; none is allowed.")
        if name in ("colour", "curvature") and lowest < 0:
            raise AttentionError(f"{name} has values below 0; 0 is the least.")
