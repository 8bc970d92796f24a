"""Section `probing` of `params.yaml`, which names planned strategies and policies."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from visuohaptic.active.registry import StrategyName, is_policy
from visuohaptic.base.section import Section
from visuohaptic.fixations.places import Unreachable

MOST_DRAWS = 1000


class ProbingParameters(Section):
    """How probing locations are chosen."""

    strategies: tuple[StrategyName, ...] = Field(
        ("fixation", "random"), min_length=1, description="Strategies and policies to compare"
    )
    unreachable: Unreachable = Field(
        "replace",
        description="Locations out of the sensor's reach: `replace` touches the view's next location instead and "
        "passes over at most 16; `skip` touches none instead, so that sequences are shorter; `keep` touches as far as "
        "the sensor comes; strategy `random` always replaces, `random_anywhere` always keeps",
    )
    when_exhausted: Literal["stop", "begin_again"] = Field(
        "stop",
        description="Sequences in views without further locations: `stop` makes them shorter, `begin_again` "
        "repeats their locations from the first",
    )
    random_draws: int = Field(
        5,
        ge=1,
        le=MOST_DRAWS,
        description="Draws of each random strategy that needs no view, such as `random`; the headline "
        "classifier of pipeline `paper` is measured on each draw, all other figures use the first",
    )

    @property
    def planned(self) -> tuple[str, ...]:
        """The strategies that choose all locations before the first touch."""
        return tuple(name for name in self.strategies if not is_policy(name))

    @property
    def policies(self) -> tuple[str, ...]:
        """The policies, which choose each location by the touches before."""
        return tuple(name for name in self.strategies if is_policy(name))
