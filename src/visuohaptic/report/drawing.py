"""The style, colours and marks of charts, and charts as SVG with the colours and the font of the page.

A chart is 360 units wide. A phone shows one unit as about one pixel, so text has at least 9 units.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from types import MappingProxyType
from typing import Any

from markupsafe import Markup, escape
from matplotlib import rc_context, rcParamsDefault
from matplotlib.axes import Axes
from matplotlib.figure import Figure

COLOURS: Mapping[str, str] = MappingProxyType(
    {
        "ink": "#1c2126", "quiet": "#555d66", "line": "#c9cdd1", "paper": "#fdfdfb", "bad": "#b3261e",
        "fixation": "#0b57a4", "random": "#a34a00", "third": "#5c2a86", "fourth": "#3d5c1e",
        "fifth": "#00707a", "sixth": "#a0195c", "seventh": "#6b6100", "eighth": "#4a5560",
        "ninth": "#7a3b12", "tenth": "#1f7a55", "eleventh": "#2f3f9e",
    }
)  # fmt: skip
"""Colours by name. The page's style replaces each by its own colour of this name, light or dark."""

_SERIES = tuple(COLOURS)[5:]
_MARKS = "osD^vP*XpH<"

INCH = 72
"""Units per inch."""

_STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 9.5,
    "text.color": COLOURS["ink"],
    "axes.labelcolor": COLOURS["quiet"],
    "axes.labelsize": 9.5,
    "axes.edgecolor": COLOURS["line"],
    "axes.facecolor": "none",
    "axes.spines.left": False,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "figure.facecolor": "none",
    "grid.color": COLOURS["line"],
    "grid.linewidth": 0.6,
    "legend.fontsize": 9.5,
    "legend.frameon": False,
    "lines.linewidth": 1.5,
    "lines.markersize": 5.5,
    "svg.fonttype": "none",
    "xtick.color": COLOURS["quiet"],
    "xtick.labelsize": 9.5,
    "xtick.major.size": 0,
    "ytick.color": COLOURS["quiet"],
    "ytick.labelsize": 9.5,
    "ytick.major.size": 0,
}
# The defaults come first so that the same tables give the same chart under any matplotlibrc. Matplotlib chooses the
# backend.
_WHOLE_STYLE: dict[Any, Any] = {**rcParamsDefault, **_STYLE}
_WHOLE_STYLE.pop("backend")

_DROPPED = re.compile(
    r"<metadata>.*?</metadata>|<defs>\s*<style.*?</style>\s*</defs>|<g/>"
    r'| transform="rotate\(-?0 [^"]*"| id="[^"_]+_\d+"',
    re.DOTALL,
)
_LONG_NUMBER = re.compile(r"-?\d+\.\d{3,}")


def look(index: int) -> tuple[str, str]:
    """Return colour and mark of the series with an index; series differ in both, for readers who see no colour."""
    turn, place = divmod(index, len(_SERIES))
    return COLOURS[_SERIES[place]], _MARKS[(place + turn) % len(_MARKS)]


class Chart(Figure):
    """A figure that a notebook shows as SVG, without pyplot."""

    def _repr_svg_(self) -> str:
        return write_svg(self)


@contextmanager
def style() -> Iterator[None]:
    """Set Matplotlib to the page's style within a context or decorated function; restore the settings after."""
    with rc_context(_WHOLE_STYLE):
        yield


def new_chart(height: float, width: float = 360) -> tuple[Chart, Axes]:
    """Return an empty chart of a height and width in units; call it within `style`."""
    chart = Chart(figsize=(width / INCH, height / INCH), layout="constrained")
    axes = chart.subplots()
    for background in (chart.patch, axes.patch):
        background.set_visible(False)
    return chart, axes


def write_svg(figure: Figure, salt: str = "visuohaptic") -> str:
    """Return a figure as SVG: the same bytes for the same figure and salt, with text as text.

    `salt` makes the ids of the elements unique.
    """
    stored = io.StringIO()
    with style(), rc_context({"svg.hashsalt": salt}):
        figure.savefig(stored, format="svg", metadata={"Date": None})
    return stored.getvalue()


def inline_svg(figure: Figure, name: str, text: str) -> Markup:
    """Return a figure as an SVG element for a page, in the page's colours and as wide as its container.

    `name` is unique on the page and makes the ids unique; `text` describes the figure for screen readers.
    """
    svg = _DROPPED.sub("", write_svg(figure, name)).replace("xlink:href", "href")
    start, view = svg.index("<svg"), re.search(r'viewBox="[^"]*"', svg)
    inner = svg[svg.index(">", start) + 1 :]
    inner = _LONG_NUMBER.sub(lambda number: f"{float(number[0]):.2f}", inner)
    for colour, value in COLOURS.items():
        inner = inner.replace(value, f"var(--{colour})")
    opening = f'<svg role="img" {view[0] if view else ""} aria-label="{escape(text)}">'
    return Markup(re.sub(r"\s*\n\s*", "\n", opening + inner))  # noqa: S704 - Matplotlib escapes its texts
