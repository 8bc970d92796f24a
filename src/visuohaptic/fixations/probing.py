"""Strategies: the ways to choose where to touch."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from typing import Annotated, Any, Literal

from pydantic import ValidatorFunctionWrapHandler, WrapValidator

from visuohaptic.base.draws import DRAW_MARK
from visuohaptic.base.errors import RegistryError
from visuohaptic.base.registry import Registry

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


def _of(module: str) -> Callable[..., Any]:
    """Return a function that imports a module of `strategies` on its first call: names are checked without it."""
    return partial(_choose, module)


def _choose(module: str, *arguments: Any) -> Any:
    choose = import_module(f"visuohaptic.fixations.strategies.{module}").choose
    return choose(*arguments)


STRATEGIES = Registry(
    "probing strategy",
    Strategy(
        "fixation",
        "eye fixations",
        _of("fixation"),
        random=False,
    ),
    Strategy(
        "random",
        "random probing",
        _of("anywhere"),
        looks=False,
        unreachable="replace",
    ),
    Strategy(
        "random_anywhere",
        "random probing, out of reach too",
        _of("anywhere"),
        looks=False,
        unreachable="keep",
        chance="random",
    ),
    Strategy(
        "random_visible",
        "random probing of what is seen",
        _of("visible"),
        looks=False,
    ),
    Strategy(
        "random_walk",
        "a random walk over the surface",
        _of("random_walk"),
        looks=False,
    ),
    Strategy(
        "farthest_point",
        "farthest points",
        _of("farthest_point"),
        looks=False,
    ),
    Strategy(
        "curvature",
        "the most curved places",
        _of("curvature"),
        random=False,
    ),
    Strategy(
        "contour",
        "places along the outline",
        _of("contour"),
        random=False,
    ),
    Strategy(
        "human",
        "where people are predicted to look",
        _of("human"),
        random=False,
    ),
)
"""Every strategy that places touches from a view or the surface, in the order of reports."""


def strategy_of(name: str) -> Strategy:
    """Return the strategy of a name, which may be that of a draw, such as ``random#2``.

    A draw has random generators of its own, also for the sensor's noise. Draw 0 has the name of the
    strategy. Raises `RegistryError` if there is no such strategy, or it draws nothing.
    """
    if DRAW_MARK not in name:
        return STRATEGIES[name]
    strategy, _, draw = name.partition(DRAW_MARK)
    entry = STRATEGIES[strategy]
    if not entry.random or not re.fullmatch("[1-9][0-9]{0,5}", draw):
        raise RegistryError(
            f"{name!r} is no draw of a random strategy; a random strategy and a number from 1 on are "
            "allowed, such as 'random#1'."
        )
    chance = f"{entry.chance or strategy}{DRAW_MARK}{draw}"
    return replace(entry, name=name, label=f"{entry.label}, draw {draw}", chance=chance)


def can_draw_again(name: str) -> bool:
    """Return whether a run measures further draws of a strategy: it is random, and needs no view."""
    entry = strategy_of(name)
    return entry.random and not entry.looks


def _check_draw(value: object, check: ValidatorFunctionWrapHandler) -> object:
    if not isinstance(value, str) or DRAW_MARK not in value:
        return check(value)
    try:
        return strategy_of(value).name
    except RegistryError as error:
        raise ValueError(str(error)) from None


StrategyName = Annotated[str, STRATEGIES, WrapValidator(_check_draw)]
"""A strategy, or a draw of a random one."""
