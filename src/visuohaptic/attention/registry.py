"""The channels and the terms: one entry holds all that there is to know of each.

The library that computes them is imported where it is called, so that names and weights can be
checked without.
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
    """One feature that draws the eye. It has either planes or stacks.

    Attributes
    ----------
    name : str
        What parameters and tables call it.
    description : str
        What it measures, in a few words.
    planes : callable, optional
        Takes a view on the working image, n rows and columns, and the model's parameters; gives
        `count` planes, shape (n, n), float32, multiplied by the view's certainty.
    stacks : callable, optional
        Takes the same; gives planes of its own for each centre level.
    count : int
        How many planes it has.
    two_sided : bool
        Whether places below their surroundings draw the eye as those above do.
    needs : {"hues", "colours", "curvature"}, optional
        What must vary over a view, or be there, for the channel to see anything: the channel is
        skipped in views without. A channel that names nothing is never skipped.
    weight : float
        How much it adds to the saliency map by default.
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
            raise AttentionError(
                f"channel {self.name} has {'neither planes nor' if self.planes is None else 'planes and'}"
                " stacks; one of the two is needed."
            )


@dataclass(frozen=True)
class Term:
    """One thing that people's gaze depends on besides the channels; `source` says who found it.

    `plane` takes a `SeenSurface` and gives (n, n), float32, of about unit size. `kind` is ``view``,
    ``place`` or ``shape``: what of the surface it depends on.
    """

    name: str
    description: str
    source: str
    plane: Callable[[Any], Any]
    kind: str


def channel(name: str) -> Channel:
    """Give a channel by its name; `AttentionError` if there is none."""
    if name not in CHANNELS:
        raise AttentionError(f"{name!r} is no channel; {', '.join(CHANNELS)} are allowed.")
    return CHANNELS[name]


def _of_view(name: str) -> Callable[..., list[Any]]:
    """Name a function of `channels`, which takes the view only."""
    return lambda view, _parameters: getattr(import_module(".channels", __package__), name)(view)


def _of_surface(name: str, *settings: float) -> Callable[[Any], Any]:
    """Name a function of `terms`, and what it takes beside the surface."""
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
"""Every channel, in the order in which maps are added up."""

TERMS = {entry.name: entry for entry in (
    Term("centre", "Nearness to the middle of what is seen", _TATLER, _of_surface("nearness_to_centre", 0.2), "view"),
    Term("middle", "The same, over a wider range", _TATLER, _of_surface("nearness_to_centre", 0.5), "view"),
    Term("facing", "How much the surface faces the eye", _WANG, attrgetter("facing"), "view"),
    Term("height", "Height above the object's middle", _CERF, _of_surface("place", 1), "place"),
    Term("height_squared", "Height, squared", _CERF, _of_surface("place", 1, 1), "place"),
    Term("front", "Place towards the object's front", _WANG, _of_surface("place", 2), "place"),
    Term("front_squared", "Place along front and back, squared", _LEIFMAN, _of_surface("place", 2, 2), "place"),
    Term("front_height", "Place towards the front, times height", _CERF, _of_surface("place", 2, 1), "place"),
    Term("side_squared", "Place to either side, squared", _LEIFMAN, _of_surface("place", 0, 0), "place"),
    Term("extremity", "Distance from the object's middle", _LEIFMAN, _of_surface("distance_from_middle"), "place"),
    Term("protrusion_fine", "How far the surface stands out of its surroundings, 0.05 radii", _LEE, _of_surface("protrusion", 0.05), "shape"),
    Term("protrusion_middle", "The same, 0.1 radii", _LEE, _of_surface("protrusion", 0.1), "shape"),
    Term("protrusion_coarse", "The same, 0.2 radii", _LEE, _of_surface("protrusion", 0.2), "shape"),
    Term("relief_fine", "How far it lies out of or in its surroundings, 0.05 radii", _LEE, _of_surface("relief", 0.05), "shape"),
    Term("relief_middle", "The same, 0.1 radii", _LEE, _of_surface("relief", 0.1), "shape"),
    Term("relief_coarse", "The same, 0.2 radii", _LEE, _of_surface("relief", 0.2), "shape"),
    Term("crowding", "Share of the surroundings that the object fills, 0.3 radii", _LEIFMAN, _of_surface("visible_share", 0.3), "shape"),
)}  # fmt: skip
"""Every term, in the order in which terms are added up."""
