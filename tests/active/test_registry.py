"""Policies stand beside the planned strategies, in one set of names."""

import pytest

from visuohaptic.active.policies import Policy
from visuohaptic.active.registry import (
    STRATEGIES,
    has_further_draws,
    is_policy,
    policy_of,
    strategy_of,
)
from visuohaptic.base.errors import RegistryError
from visuohaptic.fixations.probing import PLANNED


def test_every_entry_is_a_planned_strategy_or_a_policy():
    assert STRATEGIES.names[: len(PLANNED.names)] == PLANNED.names
    own = STRATEGIES.names[len(PLANNED.names) :]
    assert own[0] == "seek_relief"
    assert [name for name in STRATEGIES.names if isinstance(STRATEGIES[name], Policy)] == [*own]


def test_names_of_policies_and_strategies_are_told_apart():
    assert is_policy("seek_relief")
    assert not is_policy("fixation")
    assert policy_of("seek_relief#2").random_stream == "seek_relief#2"
    assert strategy_of("seek_relief").needs_view is False
    assert has_further_draws("seek_relief")
    with pytest.raises(RegistryError, match="'random' chooses before the first touch"):
        policy_of("random")
