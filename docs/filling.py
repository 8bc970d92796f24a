"""What fills pages: Markdown tables, figures of studies as a run gave them, and the blocks between two markers."""

from __future__ import annotations

import io
import json
import re
import textwrap
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PIL import Image

from visuohaptic.evaluation.intervals import SIGNIFICANCE
from visuohaptic.report.drawing import style
from visuohaptic.report.estimates import Estimate
from visuohaptic.report.wording import listed, probability
from visuohaptic.studies.keeping import kept_file, read_figures, read_source

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOCS = Path(__file__).parent
SETS = {"paper": "12 objects", "benchmark": "142 objects"}
Figures = Mapping[str, Any]
Sets = Mapping[str, Figures]


def fill_from_figures(
    sets: Sets,
    page: Path,
    blocks: Callable[[Sets], Mapping[str, str]],
    picture: Path,
    draw: Callable[[Sets], Figure],
) -> None:
    """Fill a page and draw its picture from the figures of each set."""
    fill_page(page, blocks(sets))
    save_picture(draw(sets), picture)


def save_picture(chart: Figure, path: Path, dpi: int = 110) -> None:
    """Write a chart as a PNG of 128 colours on white, without metadata: the same chart gives the same bytes.

    With the default `dpi` pixels per inch the text of a chart is as large as the text of a page.
    """
    drawn = io.BytesIO()
    with style():
        chart.savefig(drawn, format="png", dpi=dpi)
    image = Image.open(drawn)
    ground = Image.new("RGBA", image.size, "white")
    ground.alpha_composite(image)
    colours = ground.convert("RGB").quantize(128, dither=Image.Dither.NONE)
    colours.save(path, optimize=True)


def resized(chart: Figure, height: int, width: int = 760) -> Figure:
    """Give a chart a size in pixels of `save_picture`, so that the page of a study has room for it in two screens."""
    chart.set_size_inches(width / 110, height / 110)
    return chart


def legend_beside(chart: Figure) -> Figure:
    """Move the legend of a chart from below the axes to their right, so that a low chart has room for its lines."""
    (axes,), (legend,) = chart.axes, chart.legends
    legend.remove()
    handles, labels = axes.get_legend_handles_labels()
    wrapped_labels = [textwrap.fill(label, 32) for label in labels]
    chart.legend(handles, wrapped_labels, loc="outside right center", frameon=False, fontsize=9.5)
    return chart


def kept_figures(kept: Path) -> dict[str, Figures]:
    """Read the figures of a page, by set, from files ``<kept>_<set>.json``."""
    return {name: read_json(kept.with_name(f"{kept.name}_{name}.json")) for name in SETS}


def figures_of_study(folder: Path, sets: Iterable[str] = SETS) -> dict[str, Any]:
    """Read the kept figures of a study by set."""
    return {name: read_figures(folder, name)[0] for name in sets}


def measured(folder: Path, sets: Mapping[str, str] = SETS) -> str:
    """Say when and at which commit the kept result of each set was measured; `sets` has the words for each set."""
    places: dict[str, list[str]] = {}
    for name, words in sets.items():
        table = kept_file(folder, name)
        source = read_source(table) if table.exists() else read_figures(folder, name)[1]
        # After the 40 digits of a commit stands whether the code had other edits.
        commit = source.commit[:12] + source.commit[40:]
        places.setdefault(f"{source.date}, commit {commit}", []).append(words)
    said = "; ".join(f"{listed(words)}: {place}" for place, words in places.items())
    return wrapped(f"Measured once and kept; {said}.")


def read_json(path: Path) -> Any:
    """Read a JSON file."""
    return json.loads(path.read_text(encoding="utf-8"))


def table(heads: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """Write a Markdown table."""
    heads = list(heads)
    lines = [f"| {' | '.join(map(str, cells))} |" for cells in (heads, *rows)]
    return "\n".join([lines[0], "|---" * len(heads) + "|", *lines[1:]])


def plain(text: str) -> str:
    """Return a text with plain spaces."""
    return text.replace("\N{NO-BREAK SPACE}", " ")


def wrapped(text: str, indent: str = "") -> str:
    """Return a paragraph of lines of at most 100 characters; `indent` begins each line except the first."""
    joined = text.replace(" %", "\N{NO-BREAK SPACE}%")
    return plain(textwrap.fill(joined, 100, subsequent_indent=indent, break_on_hyphens=False))


def share(value: float, decimals: int = 1) -> str:
    """Write a share in per cent."""
    return f"{100 * value:.{decimals}f} %"


def points(value: float) -> str:
    """Write a difference in percentage points."""
    return f"{100 * value:+.1f}".replace("-", "\N{MINUS SIGN}")


def accuracy(cell: Figures) -> str:
    """Write an accuracy with its interval."""
    return f"{share(cell['accuracy'])} ({100 * cell['low']:.1f}–{100 * cell['high']:.1f})"


def estimated(figure: Estimate) -> str:
    """Write a share with its interval, such as ``70.0 % (62.1–77.8)``."""
    if figure.low is None or figure.high is None:
        return share(figure.mean)
    return f"{share(figure.mean)} ({100 * figure.low:.1f}–{100 * figure.high:.1f})"


def difference(cell: Figures, *names: str) -> str:
    """Write a difference in percentage points with its interval and, if it is named, its p value; empty where there is none."""
    value, low, high, *p_value = (cell[name] for name in names)
    if value is None:
        return ""
    tested = "".join(f", p {one:.2g}" for one in p_value)
    return f"{points(value)} ({points(low)} to {points(high)}){tested}"


def lead_with_p(lead: float, p_value: float, adjusted: float) -> str:
    """Write a lead in percentage points with its p value, bold if the p value `adjusted` for all leads is below 0.05."""
    written = f"{points(lead)}, p {probability(p_value)}"
    return f"**{written}**" if adjusted < SIGNIFICANCE else written


def lead_in_both(cell: Figures, name: str, adjusted: float) -> str:
    """Write a lead in percentage points with its intervals of new objects and, after a semicolon, of new classes.

    `name` is the lead's name in the cell. Bold if the p value `adjusted` for all leads is below 0.05.
    """
    lead = f"**{points(cell[name])}**" if adjusted < SIGNIFICANCE else points(cell[name])
    ends = [
        f"{points(cell[f'{name}{population}_low'])} to {points(cell[f'{name}{population}_high'])}"
        for population in ("", "_new_classes")
    ]
    return f"{lead} ({'; '.join(ends)})"


def fill_page(page: Path, blocks: Mapping[str, str]) -> None:
    """Replace what stands between the two markers of each block of a page."""
    text = page.read_text(encoding="utf-8")
    for name, content in blocks.items():
        text = fill(text, name, content)
    page.write_text(text, encoding="utf-8")


def fill(text: str, name: str, content: str) -> str:
    """Replace what stands between ``<!-- name -->`` and ``<!-- /name -->`` in a page."""
    pattern = re.compile(rf"(<!-- {name} -->\n).*?(<!-- /{name} -->)", re.DOTALL)
    filled, found = pattern.subn(lambda match: f"{match[1]}{content}\n{match[2]}", text)
    if not found:
        raise SystemExit(f"The page has no block {name}; `<!-- {name} -->` is needed.")
    return filled
