"""What fills pages: Markdown tables, figures of studies as a run gave them, and the blocks between two markers."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable, Iterable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOCS = Path(__file__).parent
SETS = {"paper": "12 objects", "benchmark": "142 objects"}
COLOURS = ("#0b57a4", "#a34a00", "#5c2a86", "#3d5c1e")

Figures = Mapping[str, Any]
Sets = Mapping[str, Figures]


def fill_from_figures(
    kept: Path,
    page: Path,
    blocks: Callable[[Sets], Mapping[str, str]],
    picture: Path,
    draw: Callable[[Sets], Figure],
    of_run: Callable[[], Figures] | None = None,
) -> None:
    """Fill a page and draw its picture from the kept figures of a study.

    With a set and a command behind the script's name, it first keeps the figures of the run that is there.
    """
    if of_run and len(sys.argv) > 2:
        keep_figures(kept, of_run())
    sets = kept_figures(kept)
    fill_page(page, blocks(sets))
    draw(sets).savefig(picture, dpi=100)


def kept_figures(kept: Path) -> dict[str, Figures]:
    """Read the kept figures of a study, by set, from files ``<kept>_<set>.json``."""
    return {name: read_json(_of_set(kept, name)) for name in SETS}


def keep_figures(kept: Path, figures: Figures) -> None:
    """Keep the figures of a run, with today's date, as the words behind the script's name say: a set, and the command."""
    name, *command = sys.argv[1:]
    date = datetime.now(UTC).strftime("%Y-%m-%d")
    found = {"command": " ".join(command), "date": date, **figures}
    text = json.dumps(found, indent=1, ensure_ascii=False)
    _of_set(kept, name).write_text(f"{text}\n", encoding="utf-8")


def _of_set(kept: Path, name: str) -> Path:
    return kept.with_name(f"{kept.name}_{name}.json")


def read_json(path: Path) -> Any:
    """Read a JSON file."""
    return json.loads(path.read_text(encoding="utf-8"))


def commands(sets: Mapping[str, Figures]) -> str:
    """List the commands that gave kept figures, with their dates."""
    lines = (f"- {SETS[name]}, {one['date']}: `{one['command']}`" for name, one in sets.items())
    return "\n".join(lines)


def table(heads: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """Write a Markdown table."""
    heads = list(heads)
    lines = [f"| {' | '.join(map(str, cells))} |" for cells in (heads, *rows)]
    return "\n".join([lines[0], "|---" * len(heads) + "|", *lines[1:]])


def share(value: float, decimals: int = 1) -> str:
    """Write a share in per cent."""
    return f"{100 * value:.{decimals}f} %"


def points(value: float) -> str:
    """Write a difference in percentage points."""
    return f"{100 * value:+.1f}".replace("-", "\N{MINUS SIGN}")


def accuracy(cell: Figures) -> str:
    """Write an accuracy with its interval."""
    return f"{share(cell['accuracy'])} ({100 * cell['low']:.1f}–{100 * cell['high']:.1f})"


def difference(cell: Figures, *names: str) -> str:
    """Write a difference in percentage points, its interval and p value, by their names; empty where there is none."""
    value, low, high, p_value = (cell[name] for name in names)
    if value is None:
        return ""
    return f"{points(value)} ({points(low)} to {points(high)}), p {p_value:.2g}"


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
