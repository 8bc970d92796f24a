"""The registry of policies beside the planned strategies, and look-up by name.

A planned strategy chooses all locations before the first touch. A policy chooses each location by the touches before.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import ValidatorFunctionWrapHandler, WrapValidator

from visuohaptic.active import seek_relief
from visuohaptic.active.policies import Policy
from visuohaptic.base.draw_names import DRAW_MARK
from visuohaptic.base.errors import RegistryError
from visuohaptic.base.registry import Registry
from visuohaptic.fixations.probing import PLANNED, Strategy, entry_of

STRATEGIES: Registry[Strategy | Policy] = Registry(
    "probing strategy",
    Policy(
        "seek_relief",
        "where relief is expected from touch",
        seek_relief.next_location,
    ),
    extends=PLANNED,
)
"""Every planned strategy, then every policy, in the order of the report."""


def strategy_of(name: str) -> Strategy | Policy:
    """Return a strategy or policy by its name or the name of a draw; raise `RegistryError` as `entry_of`."""
    entry: Strategy | Policy = entry_of(STRATEGIES, name)
    return entry


def is_policy(name: str) -> bool:
    """Return whether a registered name, or the name of a draw, is of a policy; raise `RegistryError` if unknown."""
    return isinstance(strategy_of(name), Policy)


def policy_of(name: str) -> Policy:
    """Return a policy by its name or the name of a draw; raise `RegistryError` if unknown or of a strategy."""
    entry = strategy_of(name)
    if not isinstance(entry, Policy):
        raise RegistryError(f"{name!r} chooses before the first touch; a policy is needed.")
    return entry


def has_further_draws(name: str) -> bool:
    """Return whether a run adds draws 1, 2, … of a strategy or policy: it must be random and need no view.

    Parameter `probing.random_draws` sets the number of draws. Raises `RegistryError` if the name is unknown.
    """
    entry = strategy_of(name)
    return entry.random and not entry.needs_view


def _check_name(value: object, check: ValidatorFunctionWrapHandler) -> object:
    """Return a valid name; `check` validates names without ``#``, `strategy_of` names of draws."""
    if not isinstance(value, str) or DRAW_MARK not in value:
        return check(value)
    try:
        return strategy_of(value).name
    except RegistryError as error:
        raise ValueError(str(error)) from None


StrategyName = Annotated[str, STRATEGIES, WrapValidator(_check_name)]
"""Type of a parameter: name of a strategy or policy, or of a draw of a random strategy or policy."""
