"""Loops whose number of turns is bounded, so that a mistake in the package ends in an error and not in waiting."""

from __future__ import annotations

from collections.abc import Iterator

from visuohaptic.base.errors import EndlessLoopError


def turns(most: int, loop: str) -> Iterator[int]:
    """Yield the number of each turn, from 0, of a loop that can need at most `most` turns.

    `loop` names the loop in the error, such as ``the shrinking of squares``. Raises `EndlessLoopError` if the loop asks
    for a further turn.
    """
    yield from range(most)
    raise EndlessLoopError(
        f"{loop} took more than {most} turns, which no input needs; this is a mistake in visuohaptic, please report it."
    )
