"""Names of draws: a random strategy's places may be drawn several times."""

from __future__ import annotations

DRAW_MARK = "#"
"""Stands between the name of a random strategy and the number of a draw, as in ``random#2``."""


def name_of_draw(strategy: str, draw: int) -> str:
    """Return the name of a draw of a random strategy, such as ``random#2``; draw 0 has the strategy's own name."""
    return f"{strategy}{DRAW_MARK}{draw}" if draw else strategy


def draw_of(name: str) -> tuple[str, int]:
    """Return the strategy and the number of the draw that a name such as ``random#2`` means."""
    strategy, _, draw = name.partition(DRAW_MARK)
    return strategy, int(draw or 0)
