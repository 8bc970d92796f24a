"""Strategies: the ways to choose where to touch; their code is imported when it is used."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from visuohaptic.functions import Function
from visuohaptic.registry import Registry

Unreachable = Literal["replace", "keep"]
"""What is done with a place that the sensor can't reach."""


@dataclass(frozen=True)
class Strategy:
    """A way to choose where to touch.

    Attributes
    ----------
    name : str
        What parameters and tables call it.
    label : str
        What the report calls it.
    choose : callable
        Takes a viewpoint, the section `attention` and a generator; gives places in the order in
        which they are touched: a scan path where pixels of the view are chosen, otherwise
        points with outward normals. They are as many as `attention.fixations`, or fewer where
        there are no more; fewer are the first of more.
    random : bool
        Whether the generator changes the places.
    looks : bool
        Whether it needs the view and its saliency; one that does not takes any `Standpoint`.
    unreachable : {"replace", "keep"}, optional
        What is done with its places out of reach, whatever `probing.unreachable` says; without it
        as that says.
    chance : str, optional
        Name of its generators, also of the sensor's noise; without it its own name. Strategies
        with one name draw the same.
    """

    name: str
    label: str
    choose: Callable[..., Any]
    random: bool = True
    looks: bool = True
    unreachable: Unreachable | None = None
    chance: str | None = None


STRATEGIES = Registry(
    "probing strategy",
    Strategy(
        "fixation",
        "eye fixations",
        Function("visuohaptic.fixations.strategies.fixation:choose"),
        random=False,
    ),
    Strategy(
        "random",
        "random probing",
        Function("visuohaptic.fixations.strategies.anywhere:choose"),
        looks=False,
        unreachable="replace",
    ),
    Strategy(
        "random_anywhere",
        "random probing, out of reach too",
        Function("visuohaptic.fixations.strategies.anywhere:choose"),
        looks=False,
        unreachable="keep",
        chance="random",
    ),
    Strategy(
        "random_visible",
        "random probing of what is seen",
        Function("visuohaptic.fixations.strategies.visible:choose"),
        looks=False,
    ),
    Strategy(
        "random_walk",
        "a random walk over the surface",
        Function("visuohaptic.fixations.strategies.random_walk:choose"),
        looks=False,
    ),
    Strategy(
        "farthest_point",
        "farthest points",
        Function("visuohaptic.fixations.strategies.farthest_point:choose"),
        looks=False,
    ),
    Strategy(
        "curvature",
        "the most curved places",
        Function("visuohaptic.fixations.strategies.curvature:choose"),
        random=False,
    ),
    Strategy(
        "contour",
        "places along the outline",
        Function("visuohaptic.fixations.strategies.contour:choose"),
        random=False,
    ),
    Strategy(
        "human",
        "where people are predicted to look",
        Function("visuohaptic.fixations.strategies.human:choose"),
        random=False,
    ),
)
"""Every strategy that places touches from a view or the surface, in the order of reports."""


StrategyName = Annotated[str, STRATEGIES]
