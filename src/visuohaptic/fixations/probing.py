"""Strategies: the ways to choose where to touch, before the first touch or, as a policy, by what was felt."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

from pydantic import ValidatorFunctionWrapHandler, WrapValidator

from visuohaptic.base.draws import DRAW_MARK
from visuohaptic.base.errors import RegistryError
from visuohaptic.base.registry import Registry
from visuohaptic.fixations.policies import Policy
from visuohaptic.fixations.strategies import (
    anywhere,
    contour,
    curvature,
    farthest_point,
    fixation,
    human,
    random_walk,
    seek_relief,
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


STRATEGIES: Registry[Strategy | Policy] = Registry(
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
    Policy(
        "seek_relief",
        "where relief is expected from touch",
        seek_relief.next_location,
    ),
)
"""Every strategy and every policy, in the order of reports."""


def strategy_of(name: str) -> Strategy | Policy:
    """Return the strategy or policy of a name, which may be that of a draw, such as ``random#2``.

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


def is_policy(name: str) -> bool:
    """Return whether a name is that of a policy, which chooses by what was felt."""
    return isinstance(strategy_of(name), Policy)


def policy_of(name: str) -> Policy:
    """Return the policy of a name; raises `RegistryError` if it is none."""
    entry = strategy_of(name)
    if not isinstance(entry, Policy):
        raise RegistryError(f"{name!r} chooses before the first touch; a policy is needed.")
    return entry


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
