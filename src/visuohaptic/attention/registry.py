"""The channels and the terms: one entry each, with name, description and function.

The modules with the functions are imported on the first call, so that checking names and weights does not
import OpenCV.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from operator import attrgetter
from typing import Any, Literal

from .errors import AttentionError


@dataclass(frozen=True)
class Channel:
    """A feature that draws the eye. A channel has either `planes` or `stacks`.

    Attributes
    ----------
    name : str
        Name in parameters and tables.
    description : str
        The measured feature in a few words.
    planes : callable, optional
        ``planes(view, parameters)`` takes a `WorkingView` of n rows and columns and the model's parameters. It
        returns `count` planes (n, n), float32, multiplied by the view's certainty.
    stacks : callable, optional
        ``stacks(view, parameters)`` returns one list of planes per centre level.
    count : int
        Number of planes.
    two_sided : bool
        Whether values below their surroundings draw the eye too.
    needs : {"hues", "colours", "curvature"}, optional
        The channel is skipped in views without hues, with one colour, or with one curvature. Without a value
        the channel is skipped only for weight 0, or in a view without the object.
    weight : float
        Default weight in the saliency map.
    """

    name: str
    description: str
    planes: Callable[..., list[Any]] | None = None
    stacks: Callable[..., list[list[Any]]] | None = None
    count: int = 1
    two_sided: bool = False
    needs: Literal["hues", "colours", "curvature"] | None = None
    weight: float = 1.0

    def __post_init__(self) -> None:
        if (self.planes is None) == (self.stacks is None):
            both_or_none = "neither planes nor" if self.planes is None else "planes and"
            raise AttentionError(
                f"channel {self.name} has {both_or_none} stacks; one of the two is needed."
            )


@dataclass(frozen=True)
class Term:
    """A property of the surface that people's gaze depends on besides the channels.

    Attributes
    ----------
    name : str
        Name in parameters.
    description : str
        The measured property in a few words.
    source : str
        The publication that found the dependence.
    plane : callable
        ``plane(seen)`` takes a `SeenSurface` and returns values (n, n) of about unit size.
    kind : {"view", "place", "shape"}
        Whether the term depends on the view, on the position on the object, or on the surface's shape.
    """

    name: str
    description: str
    source: str
    plane: Callable[[Any], Any]
    kind: str


def channel(name: str) -> Channel:
    """Return a channel by its name; raise `AttentionError` if there is none."""
    if name not in CHANNELS:
        raise AttentionError(f"{name!r} is no channel; {', '.join(CHANNELS)} are allowed.")
    return CHANNELS[name]


def _of_view(name: str) -> Callable[..., list[Any]]:
    """Return a channel's function that imports `channels` on the first call."""
    return lambda view, _parameters: getattr(import_module(".channels", __package__), name)(view)


def _of_surface(name: str, *settings: float) -> Callable[[Any], Any]:
    """Return a term's function that imports `terms` on the first call; `settings` follow the surface."""
    return lambda seen: getattr(import_module(".terms", __package__), name)(seen, *settings)


_TATLER = "Tatler 2007, J. Vision 7(14):4"
_LEE = "after Lee, Varshney & Jacobs 2005, ACM Trans. Graph. 24(3)"
_WANG = "Wang, Koch, Holmqvist & Alexa 2018, ACM Trans. Graph. 37(6)"
_LEIFMAN = "Leifman, Shtrom & Tal 2016, IEEE TPAMI 38(12)"
_CERF = "Cerf, Frady & Koch 2009, J. Vision 9(12):10 (faces and heads)"

CHANNELS = {entry.name: entry for entry in (
    Channel(
        "colour", "Red-green and blue-yellow double opponency", _of_view("colour_planes"),
        count=2, two_sided=True, needs="hues",
    ),
    Channel(
        "intensity", "Light against dark surroundings", _of_view("intensity_planes"),
        two_sided=True, needs="colours",
    ),
    Channel("orientation", "Gabor energy at each angle", stacks=_of_view("orientation_planes"), needs="colours"),
    Channel("contrast", "Local root mean square contrast", _of_view("contrast_planes"), needs="colours"),
    Channel("curvature", "Curvedness of the surface", _of_view("curvature_planes"), needs="curvature"),
    Channel("edge", "Gradient of intensity", _of_view("edge_planes"), needs="colours", weight=0.0),
    Channel("entropy", "Entropy of the local grey level histogram", _of_view("entropy_planes"), needs="colours", weight=0.0),
    Channel("symmetry", "Radial symmetry of gradients", _of_view("symmetry_planes"), needs="colours", weight=0.0),
)}  # fmt: skip
"""Every channel by its name, in the order of summation."""

TERMS = {entry.name: entry for entry in (
    Term("centre", "Nearness to the middle of the visible part", _TATLER, _of_surface("nearness_to_centre", 0.2), "view"),
    Term("middle", "Nearness to the middle of the visible part, over a wider range", _TATLER, _of_surface("nearness_to_centre", 0.5), "view"),
    Term("facing", "How much the surface faces the eye", _WANG, attrgetter("facing"), "view"),
    Term("height", "Height above the object's middle", _CERF, _of_surface("coordinate_product", 1), "place"),
    Term("height_squared", "Height, squared", _CERF, _of_surface("coordinate_product", 1, 1), "place"),
    Term("front", "Position towards the object's front", _WANG, _of_surface("coordinate_product", 2), "place"),
    Term("front_squared", "Position between back and front, squared", _LEIFMAN, _of_surface("coordinate_product", 2, 2), "place"),
    Term("front_height", "Position towards the front, times height", _CERF, _of_surface("coordinate_product", 2, 1), "place"),
    Term("side_squared", "Position to the side, squared", _LEIFMAN, _of_surface("coordinate_product", 0, 0), "place"),
    Term("extremity", "Distance from the object's middle", _LEIFMAN, _of_surface("distance_from_origin"), "place"),
    Term("protrusion_fine", "How far the surface stands out of its surroundings, 0.05 radii", _LEE, _of_surface("protrusion", 0.05), "shape"),
    Term("protrusion_middle", "How far the surface stands out of its surroundings, 0.1 radii", _LEE, _of_surface("protrusion", 0.1), "shape"),
    Term("protrusion_coarse", "How far the surface stands out of its surroundings, 0.2 radii", _LEE, _of_surface("protrusion", 0.2), "shape"),
    Term("relief_fine", "How far the surface lies above or below its surroundings, 0.05 radii", _LEE, _of_surface("relief", 0.05), "shape"),
    Term("relief_middle", "How far the surface lies above or below its surroundings, 0.1 radii", _LEE, _of_surface("relief", 0.1), "shape"),
    Term("relief_coarse", "How far the surface lies above or below its surroundings, 0.2 radii", _LEE, _of_surface("relief", 0.2), "shape"),
    Term("crowding", "Share of the surroundings that the object fills, 0.3 radii", _LEIFMAN, _of_surface("visible_share", 0.3), "shape"),
)}  # fmt: skip
"""Every term by its name, in the order of summation."""
