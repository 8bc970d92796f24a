"""Strategies: the ways to choose where to touch."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from visuohaptic.base.registry import Registry
from visuohaptic.fixations.strategies import (
    anywhere,
    contour,
    curvature,
    farthest_point,
    fixation,
    human,
    random_walk,
    visible,
)

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
        Whether it needs the view and its saliency; one that does not takes any `Viewpoint`.
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
        fixation.choose,
        random=False,
    ),
    Strategy(
        "random",
        "random probing",
        anywhere.choose,
        looks=False,
        unreachable="replace",
    ),
    Strategy(
        "random_anywhere",
        "random probing, out of reach too",
        anywhere.choose,
        looks=False,
        unreachable="keep",
        chance="random",
    ),
    Strategy(
        "random_visible",
        "random probing of what is seen",
        visible.choose,
        looks=False,
    ),
    Strategy(
        "random_walk",
        "a random walk over the surface",
        random_walk.choose,
        looks=False,
    ),
    Strategy(
        "farthest_point",
        "farthest points",
        farthest_point.choose,
        looks=False,
    ),
    Strategy(
        "curvature",
        "the most curved places",
        curvature.choose,
        random=False,
    ),
    Strategy(
        "contour",
        "places along the outline",
        contour.choose,
        random=False,
    ),
    Strategy(
        "human",
        "where people are predicted to look",
        human.choose,
        random=False,
    ),
)
"""Every strategy that places touches from a view or the surface, in the order of reports."""


StrategyName = Annotated[str, STRATEGIES]
