"""Names of draws: a run may draw the locations of a random strategy several times."""

from __future__ import annotations

DRAW_MARK = "#"
"""Separates the name of a random strategy from the number of a draw, as in ``random#2``."""


def name_of_draw(strategy: str, draw: int) -> str:
    """Return the name of a draw of a random strategy, such as ``random#2``; for draw 0 the name of the strategy."""
    return f"{strategy}{DRAW_MARK}{draw}" if draw else strategy


def draw_of(name: str) -> tuple[str, int]:
    """Return the strategy and the number of the draw from a name such as ``random#2``; number 0 without ``#``."""
    strategy, _, draw = name.partition(DRAW_MARK)
    return strategy, int(draw or 0)
