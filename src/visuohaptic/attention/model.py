"""The attention model: from views to saliency maps and fixations."""

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
from .pyramid import fill_background
from .registry import CHANNELS, TERMS
from .saliency import conspicuity_maps, resample_to_view, saliency_map
from .scanpath import Scanpath, scan
from .terms import SeenSurface, prepare_surface

SMALLEST_VIEW = 16
"""Smallest number of rows and of columns of a view."""

SMALLEST_PEAK = 1e-30
"""A map is divided by its maximum, but by no less than this, so that a map of zeros stays zero."""


@dataclass(frozen=True)
class Attention:
    """Saliency and fixations of one view.

    Attributes
    ----------
    saliency : ndarray of shape (h, w), float32
        The saliency map, scaled to a maximum of 1, and 0 on the background. All values are 0 if nothing on the object
        is salient.
    conspicuity : dict of str to ndarray of shape (h, w), float32
        The map per channel that ran: at least 0, not multiplied by the channel's weight, and 0 on the background.
    skipped : dict of str to str
        The reason per channel that did not run.
    scanpath : Scanpath
        The fixations, in order.
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
    """Compute saliency and fixations of n views; each result depends only on its own view.

    Values on the background must be finite too, but change no result.

    Parameters
    ----------
    colour : ndarray of shape (n, h, w, 3)
        Red, green and blue, at least 0, of any scale: each view is divided by its largest value on the object.
        `Views` of rendered objects have sRGB; linear light gives other maps. Numbers of any type are rounded to float32.
    mask : ndarray of shape (n, h, w), bool
        True on the object.
    point, normal : ndarray of shape (n, h, w, 3), float64
        Visible points of the surface, object radii, and unit normals, both in the object frame: y up, z to the front.
        The parameters and terms assume this unit, and the terms assume this frame.
    face : ndarray of shape (n, h, w), int64
        Index of the visible face at each pixel. It is only copied into the scanpath.
    curvature : ndarray of shape (n, h, w)
        Curvedness of the surface, at least 0, 1 / object radius. Numbers of any type are rounded to float32.
    parameters : AttentionParameters
        Weights of the channels, the operator N, and the choice of fixations.
    eye : ndarray of shape (n, 3), float64, optional
        Position of each view's eye, object frame, object radii. Needed if a term has a weight other than 0.
    terms : mapping of str to float, optional
        Weight per name of `TERMS`; missing terms have weight 0. If all are 0, the saliency map is the weighted sum of
        conspicuity maps. Otherwise it is the exponential of this sum plus the weighted sum of terms. Either map is
        then divided by its maximum.

    Returns
    -------
    list of Attention
        One result per view, in the order of the views.

    Raises
    ------
    AttentionError
        If a shape does not match `mask`, `mask` is not bool, a view has fewer than `SMALLEST_VIEW` rows or columns,
        a value is no real number, not finite or beyond float32, a colour or curvature is negative, a term is unknown, or a term has a weight other
        than 0 and `eye` is missing.
    """
    _check_views(colour, mask, point, normal, face, curvature)
    colour, curvature = _as_float32(colour, "colour"), _as_float32(curvature, "curvature")
    weights = _weights_of(terms or {})
    _check_eyes(eye, len(mask), weights)
    eyes = [None] * len(mask) if eye is None else eye
    views = zip(colour, mask, point, normal, face, curvature, eyes, strict=True)
    return [_attend_view(parameters, weights, *view) for view in views]


def reasons_to_skip(
    colour: Plane, mask: NDArray[np.bool_], curvature: Plane, parameters: AttentionParameters
) -> dict[str, str]:
    """Return the channels that add nothing to a view's saliency map, as name: reason, in the order of `CHANNELS`.

    The weight of such a channel is 0, or its map is 0 everywhere, so `attend` does not compute the map. This changes
    no bit of the saliency map. `colour` (h, w, 3), `mask` (h, w) and `curvature` (h, w) are as for `attend`, but of
    one view.
    """
    colour, curvature = _as_float32(colour, "colour"), _as_float32(curvature, "curvature")
    reasons = _empty_channels(colour, mask, curvature)
    weights = parameters.weights.model_dump()
    reasons |= {name: "its weight is 0" for name in CHANNELS if not weights.get(name)}
    return {name: reasons[name] for name in CHANNELS if name in reasons}


def term_planes(seen: SeenSurface, names: Iterable[str]) -> dict[str, Plane]:
    """Compute the planes of the terms `names` of `TERMS`, not multiplied by weights.

    Each plane has the shape (MAP_SIZE, MAP_SIZE), float32, like the planes of `seen`, and is 0 off the object.
    Raises `KeyError` if a name is no term.
    """
    shown = seen.certainty > 0
    return {name: TERMS[name].plane(seen).astype(np.float32) * shown for name in names}


def _empty_channels(colour: Plane, mask: NDArray[np.bool_], curvature: Plane) -> dict[str, str]:
    """Return the channels whose map is 0 everywhere, as name: reason; in a view without the object all channels."""
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
    """Return whether all pixels of a plane that are not 0 in `inside` have the same value."""
    lowest, highest, _, _ = cv2.minMaxLoc(plane, inside)
    return lowest == highest


def _exponential_map(total: Plane, seen: SeenSurface, weights: Mapping[str, float]) -> Plane:
    """Compute exp(total + weighted terms), scaled to a maximum of 1; fill the background from nearby pixels."""
    terms = np.zeros_like(seen.certainty)
    for name, plane in term_planes(seen, weights).items():
        terms += np.float32(weights[name]) * plane
    exponent = total + terms
    largest = float(exponent[seen.certainty > 0].max(initial=-np.inf))
    if not np.isfinite(largest):
        return np.zeros_like(total)
    value = cv2.exp(np.minimum(exponent - np.float32(largest), 0.0))
    return fill_background(value * seen.certainty, seen.certainty)


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
    """Compute the result of one view; `terms` has only weights other than 0."""
    skipped = reasons_to_skip(colour, mask, curvature, parameters)
    channels = tuple(name for name in CHANNELS if name not in skipped)
    maps = conspicuity_maps(prepare_view(colour, mask, curvature), channels, parameters)
    total = saliency_map(maps, parameters)
    if terms and eye is not None:
        total = _exponential_map(total, prepare_surface(mask, point, normal, eye), terms)
    saliency = resample_to_view(total, mask, cv2.INTER_CUBIC)
    saliency /= np.float32(max(float(saliency.max()), SMALLEST_PEAK))
    return Attention(
        saliency,
        {name: resample_to_view(plane, mask) for name, plane in maps.items()},
        skipped,
        scan(saliency, mask, point, normal, face, parameters),
    )


def _weights_of(terms: Mapping[str, float]) -> dict[str, float]:
    """Return the weights that are not 0, in the order of `TERMS`; raise if a term is unknown."""
    if unknown := sorted({*terms} - {*TERMS}):
        raise AttentionError(f"{unknown[0]!r} is no term; {', '.join(TERMS)} are allowed.")
    return {name: terms[name] for name in TERMS if terms.get(name)}


def _check_eyes(eye: NDArray[np.float64] | None, views: int, terms: Mapping[str, float]) -> None:
    if eye is None:
        if terms:
            raise AttentionError("a term has a weight, but eye is missing; terms need the eye.")
    elif eye.shape != (views, 3) or not np.isfinite(eye).all():
        raise AttentionError(
            f"eye has shape {eye.shape}; finite numbers of shape {(views, 3)} are allowed."
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
            f"at least {SMALLEST_VIEW} x {SMALLEST_VIEW} are needed."
        )
    vector = (*mask.shape, 3)
    arrays: dict[str, tuple[NDArray[Any], tuple[int, ...]]] = {
        "mask": (mask, mask.shape),
        "colour": (colour, vector),
        "point": (point, vector),
        "normal": (normal, vector),
        "face": (face, mask.shape),
        "curvature": (curvature, mask.shape),
    }
    for name, (array, shape) in arrays.items():
        if isinstance(array, np.ma.MaskedArray):
            raise AttentionError(
                f"{name} is a masked array; a plain array is needed, because masks are not read."
            )
        if array.shape != shape:
            raise AttentionError(
                f"{name} has shape {array.shape}; with this mask {shape} is allowed."
            )
        if array.dtype.kind not in "biuf":
            raise AttentionError(f"{name} is of type {array.dtype}; real numbers are allowed.")
        # Faster than np.isfinite on the whole array: the extremes are finite only if all values are finite.
        lowest, highest = array.min(initial=0), array.max(initial=0)
        if not (np.isfinite(lowest) and np.isfinite(highest)):
            raise AttentionError(f"{name} has NaN or infinite values; finite values are allowed.")
        if name in ("colour", "curvature") and lowest < 0:
            raise AttentionError(f"{name} has values below 0, such as {lowest:g}; 0 is the least.")


def _as_float32(values: NDArray[Any], name: str) -> Plane:
    """Return numbers as float32, the type of OpenCV's filters; raise `AttentionError` if float32 can't hold them."""
    if values.dtype == np.float32:
        return values
    with np.errstate(over="ignore"):
        rounded: Plane = values.astype(np.float32)
    if not np.isfinite(rounded.max(initial=0)):
        raise AttentionError(
            f"{name} has values up to {values.max():g}; values below 3.4e38 are allowed."
        )
    return rounded
