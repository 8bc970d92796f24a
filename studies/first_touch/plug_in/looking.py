"""Strategies of study `first_touch`: simple rules of looking, and parts of the model of people's gaze.

Each strategy ranks the visible places by a map over the pixels of a view, with the inhibition of return of `fixation`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import visuohaptic as vh
from visuohaptic.attention.model import attend
from visuohaptic.attention.parameters import AttentionParameters, read_fitted_weights
from visuohaptic.attention.registry import CHANNELS, TERMS
from visuohaptic.attention.scanpath import Scanpath
from visuohaptic.fixations.attended_views import AttendedView

KINDS = {
    kind: tuple(name for name, term in TERMS.items() if term.kind == kind)
    for kind in ("view", "place", "shape")
}
"""Names of the terms by kind."""

PARTS: dict[str, tuple[Collection[str], str]] = {
    "gaze_channels": (CHANNELS, "predicted gaze, channels of saliency only"),
    "gaze_view": (KINDS["view"], "predicted gaze, view only"),
    "gaze_place": (KINDS["place"], "predicted gaze, place on the object only"),
    "gaze_shape": (KINDS["shape"], "predicted gaze, shape only"),
    "gaze_facing": (("facing",), "predicted gaze, surface that faces the eye only"),
    "gaze_height": (("height", "height_squared"), "predicted gaze, height only"),
    "gaze_front": (
        ("front", "front_squared", "front_height", "side_squared"),
        "predicted gaze, front and sides only",
    ),
    "gaze_extremity": (("extremity",), "predicted gaze, distance from the middle only"),
    "gaze_without_channels": (TERMS, "predicted gaze without channels of saliency"),
    "gaze_without_place": (
        (*CHANNELS, *KINDS["view"], *KINDS["shape"]),
        "predicted gaze without place on the object",
    ),
    "gaze_without_view": (
        (*CHANNELS, *KINDS["place"], *KINDS["shape"]),
        "predicted gaze without view",
    ),
    "gaze_without_shape": (
        (*CHANNELS, *KINDS["place"], *KINDS["view"]),
        "predicted gaze without shape",
    ),
}
"""The weights of strategy `human` that a strategy keeps, and its label; all other weights are 0."""


def look_with(
    kept: Collection[str], view: AttendedView, attention: AttentionParameters, *_: object
) -> Scanpath:
    """Choose fixations by the kept weights, channels and terms by name, of the model of people's gaze."""
    fitted = read_fitted_weights()
    channels, terms = (
        {name: value if name in kept else 0.0 for name, value in fitted[kind].items()}
        for kind in ("channels", "terms")
    )
    # A copy is not validated: parameters need a channel of weight above 0, and a part may have terms only.
    weights = attention.weights.model_copy(update=channels)
    (attended,) = attend(
        **view.views.attend_arguments(slice(view.index, view.index + 1)),
        parameters=attention.model_copy(update={"weights": weights}),
        eye=np.array([view.camera.eye]),
        terms=terms,
    )
    return attended.scanpath


def heights(view: AttendedView) -> NDArray[np.float64]:
    """Return the height of each pixel's point, object radii, (h, w)."""
    return view.views.point[view.index, ..., 1]


def nearness(view: AttendedView) -> NDArray[np.float64]:
    """Return the negative distance of each pixel's point from the eye, object radii, (h, w)."""
    return -np.linalg.norm(view.views.point[view.index] - view.camera.eye, axis=-1)


def nearness_to_axis(view: AttendedView) -> NDArray[np.float64]:
    """Return the negative distance of each pixel's point from the line of sight to the centre, object radii, (h, w)."""
    axis = view.camera.eye / np.linalg.norm(view.camera.eye)
    return -np.linalg.norm(np.cross(view.views.point[view.index], axis), axis=-1)


def rank(
    measure: Callable[[AttendedView], NDArray[np.float64]],
    view: AttendedView,
    attention: AttentionParameters,
    *_: object,
) -> Scanpath:
    """Choose fixations from the highest to the lowest value of a measure, scaled to 0 to 1 over the visible surface."""
    values, mask = measure(view), view.views.mask[view.index]
    lowest, highest = (float(end(values[mask])) for end in (np.min, np.max))
    scaled = (values - lowest) / max(highest - lowest, np.finfo(np.float64).tiny)
    return view.scan(np.where(mask, scaled, 0.0).astype(np.float32), attention)


def _register(name: str, label: str, choose: Callable[..., Any]) -> None:
    vh.register(vh.Strategy(name, label, choose, random=False))


_register("highest", "the highest visible places", partial(rank, heights))
_register("nearest", "the visible places nearest to the eye", partial(rank, nearness))
_register(
    "central", "the visible places nearest to the line of sight", partial(rank, nearness_to_axis)
)
for _name, (_kept, _label) in PARTS.items():
    _register(_name, _label, partial(look_with, _kept))
