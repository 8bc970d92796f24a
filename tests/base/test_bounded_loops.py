"""A loop that takes more turns than it can need ends in an error."""

import pytest

from visuohaptic.base.bounded_loops import turns
from visuohaptic.base.errors import EndlessLoopError


def test_a_loop_of_too_many_turns_is_an_error_that_names_the_loop():
    counting = turns(3, "the counting")
    assert [next(counting) for _ in range(3)] == [0, 1, 2]
    with pytest.raises(EndlessLoopError, match="the counting took more than 3 turns"):
        next(counting)


def test_a_loop_that_ends_in_time_is_none():
    for turn in turns(3, "the counting"):
        if turn == 2:
            break
