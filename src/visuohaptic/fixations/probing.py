"""The registry of strategies, which choose all locations before the first touch, and of policies."""

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
"""Locations out of reach are replaced by the next locations, or touched as far as the sensor comes."""


@dataclass(frozen=True)
class Strategy:
    """A way to choose locations before the first touch.

    Attributes
    ----------
    name, label : str
        Name in parameters and tables, and name in the report.
    choose : callable
        ``choose(viewpoint, attention, generator)`` returns at most `attention.fixations` locations in the order
        of touching: a `Scanpath` of pixels, or `ProbingLocations` with outward normals. For fewer fixations it must
        return a prefix of the same locations.
    random : bool
        Whether the generator changes the locations.
    looks : bool
        Whether `choose` needs an `AttendedView`; if not, it takes any `Viewpoint`.
    unreachable : {"replace", "keep"}, optional
        Overrides parameter `probing.unreachable`.
    chance : str, optional
        Name for the random generators of choice and sensor noise, by default `name`. Strategies with the same
        `chance` draw the same numbers.
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
"""Every strategy and every policy, in the order of the report."""


def strategy_of(name: str) -> Strategy | Policy:
    """Return a strategy or policy by its name, or by the name of a draw such as ``random#2``.

    A draw has its own random generators for choice and sensor noise. Raises `RegistryError` if there is no such
    strategy, or if the name is that of a draw of a strategy that is not random.
    """
    if DRAW_MARK not in name:
        return STRATEGIES[name]
    strategy, _, draw = name.partition(DRAW_MARK)
    entry = STRATEGIES[strategy]
    if not entry.random or not re.fullmatch("[1-9][0-9]{0,5}", draw):
        raise RegistryError(
            f"{name!r} is no draw of a random strategy; the name of a random strategy and a number from 1 "
            "are allowed, such as 'random#1'."
        )
    chance = f"{entry.chance or strategy}{DRAW_MARK}{draw}"
    return replace(entry, name=name, label=f"{entry.label}, draw {draw}", chance=chance)


def is_policy(name: str) -> bool:
    """Return whether a name is the name of a policy."""
    return isinstance(strategy_of(name), Policy)


def policy_of(name: str) -> Policy:
    """Return a policy by its name; raise `RegistryError` if the name is no policy."""
    entry = strategy_of(name)
    if not isinstance(entry, Policy):
        raise RegistryError(f"{name!r} chooses before the first touch; a policy is needed.")
    return entry


def can_draw_again(name: str) -> bool:
    """Return whether a run measures several draws of a strategy: it must be random and need no view."""
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
"""Name of a strategy, or of a draw of a random strategy."""
