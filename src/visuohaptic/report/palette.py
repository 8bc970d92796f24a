"""Colours and marks of the charts, by the names that the page's style gives the colours."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

COLOURS: Mapping[str, str] = MappingProxyType(
    {
        "ink": "#1c2126", "quiet": "#555d66", "line": "#c9cdd1", "paper": "#fdfdfb", "bad": "#b3261e",
        "fixation": "#0b57a4", "random": "#a34a00", "third": "#5c2a86", "fourth": "#3d5c1e",
        "fifth": "#00707a", "sixth": "#a0195c", "seventh": "#6b6100", "eighth": "#4a5560",
        "ninth": "#7a3b12", "tenth": "#1f7a55",
    }
)  # fmt: skip
"""Colours by the names that the page's style gives them; a dark page has others of these names."""

_SERIES = tuple(COLOURS)[5:]
_MARKS = "osD^vP*XpH"


def look(place: int) -> tuple[str, str]:
    """Give the colour and the mark of a series, so that none is known by its colour alone."""
    return COLOURS[_SERIES[place % len(_SERIES)]], _MARKS[place % len(_MARKS)]
