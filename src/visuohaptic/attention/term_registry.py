"""The terms: what draws people's eyes besides the channels; one entry holds all there is to know of each.

Terms enter the exponent of the saliency map, so that they multiply what the channels say. The library
that computes them is imported where it is used, as in `registry`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from operator import attrgetter
from typing import Any

from .registry import by_name


@dataclass(frozen=True)
class Term:
    """One thing that people's gaze depends on.

    `source` says who found that people use it, or where the measure comes from. `plane` takes what
    a view shows of the surface and gives (n, n), float32, of about unit size. `kind` is ``view``,
    ``place`` or ``shape``: what of the surface it depends on.
    """

    name: str
    description: str
    source: str
    plane: Callable[[Any], Any]
    kind: str


def _measure(name: str, *reach: float) -> Callable[[Any], Any]:
    """Name a function of `terms`, which is imported when it is called."""
    return lambda seen: getattr(import_module(".terms", __package__), name)(seen, *reach)


def _relief(reach: float) -> Callable[[Any], Any]:
    return lambda seen: abs(_measure("protrusion", reach)(seen))


def _coordinate(axis: int, power: int, other: int | None = None) -> Callable[[Any], Any]:
    def measure(seen: Any) -> Any:
        plane = seen.point[..., axis] ** power
        return plane if other is None else plane * seen.point[..., other]

    return measure


_TATLER = "Tatler 2007, J. Vision 7(14):4"
_LEE = "after Lee, Varshney & Jacobs 2005, ACM Trans. Graph. 24(3)"
_WANG = "Wang, Koch, Holmqvist & Alexa 2018, ACM Trans. Graph. 37(6)"
_LEIFMAN = "Leifman, Shtrom & Tal 2016, IEEE TPAMI 38(12)"
_CERF = "Cerf, Frady & Koch 2009, J. Vision 9(12):10 (faces and heads)"

TERMS = by_name(
    Term("centre", "Nearness to the middle of what is seen", _TATLER, _measure("nearness_to_centre", 0.2), "view"),
    Term("middle", "The same, over a wider range", _TATLER, _measure("nearness_to_centre", 0.5), "view"),
    Term("facing", "How much the surface faces the eye", _WANG, attrgetter("facing"), "view"),
    Term("height", "Height above the object's middle", _CERF, _coordinate(1, 1), "place"),
    Term("height_squared", "Height, squared", _CERF, _coordinate(1, 2), "place"),
    Term("front", "Place towards the object's front", _WANG, _coordinate(2, 1), "place"),
    Term("front_squared", "Place along front and back, squared", _LEIFMAN, _coordinate(2, 2), "place"),
    Term("front_height", "Place towards the front, times height", _CERF, _coordinate(2, 1, 1), "place"),
    Term("side_squared", "Place to either side, squared", _LEIFMAN, _coordinate(0, 2), "place"),
    Term("extremity", "Distance from the object's middle", _LEIFMAN, _measure("distance_from_middle"), "place"),
    Term("protrusion_fine", "How far the surface stands out of its surroundings, 0.05 radii", _LEE, _measure("protrusion", 0.05), "shape"),
    Term("protrusion_middle", "The same, 0.1 radii", _LEE, _measure("protrusion", 0.1), "shape"),
    Term("protrusion_coarse", "The same, 0.2 radii", _LEE, _measure("protrusion", 0.2), "shape"),
    Term("relief_fine", "How far it lies out of or in its surroundings, 0.05 radii", _LEE, _relief(0.05), "shape"),
    Term("relief_middle", "The same, 0.1 radii", _LEE, _relief(0.1), "shape"),
    Term("relief_coarse", "The same, 0.2 radii", _LEE, _relief(0.2), "shape"),
    Term("crowding", "Share of the surroundings that the object fills, 0.3 radii", _LEIFMAN, _measure("visible_share", 0.3), "shape"),
)  # fmt: skip
"""Every term, in the order in which terms are added up."""
