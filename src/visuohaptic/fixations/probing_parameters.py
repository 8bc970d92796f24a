"""Section `probing` of `params.yaml`. It knows the strategies, which know the section `rendering`."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from visuohaptic.base.section import Section
from visuohaptic.fixations.probing import StrategyName, Unreachable, is_policy

MOST_DRAWS = 1000


class ProbingParameters(Section):
    """How probing locations are chosen."""

    strategies: tuple[StrategyName, ...] = Field(
        ("fixation", "random"), min_length=1, description="Strategies and policies to compare"
    )
    unreachable: Unreachable = Field(
        "replace",
        description="What is done with a place that the sensor can't reach: the view's next one is touched "
        "instead, with at most 16 passed over (`replace`), or it is touched as far as it goes (`keep`); "
        "`random` always replaces, `random_anywhere` never",
    )
    when_exhausted: Literal["stop", "begin_again"] = Field(
        "stop",
        description="What a sequence does where a view has no further place: it stays shorter, or it starts "
        "again at its first place",
    )
    random_draws: int = Field(
        5,
        ge=1,
        le=MOST_DRAWS,
        description="How often a run draws the places of a random strategy that needs no view, such as "
        "`random`; the headline classifier of pipeline `paper` is measured on each draw, all other figures "
        "are of the first",
    )

    @property
    def planned(self) -> tuple[str, ...]:
        """The strategies that choose all places before the first touch."""
        return tuple(name for name in self.strategies if not is_policy(name))

    @property
    def policies(self) -> tuple[str, ...]:
        """The policies, which choose each place by what was felt before."""
        return tuple(name for name in self.strategies if is_policy(name))
