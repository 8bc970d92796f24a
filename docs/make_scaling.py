"""Fill the table of docs/scaling.md and draw docs/pictures/scaling.png from benchmarks/scaling.json, with Chromium.

`python -m benchmarks.many_objects FOLDER` measures; its FOLDER/measured.json is kept as benchmarks/scaling.json.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path

import plotly.graph_objects as go
from make_lead_picture import COLOURS, SYMBOLS, photograph
from make_readme import fill_page
from plotly.subplots import make_subplots

DOCS = Path(__file__).parent
MEASURED = DOCS.parent / "benchmarks" / "scaling.json"
PAGE, PICTURE = DOCS / "scaling.md", DOCS / "pictures" / "scaling.png"
LEARNING = ("recognition_s", "study_block_s")
OBJECTS = ("meshes_s", "fixations_s", "touches_s", "features_s", "stability_s")
Steps = Mapping[str, Mapping[str, float]]


def rows_of(counts: Mapping[int, Steps]) -> dict[str, tuple[str, dict[int, float]]]:
    """Give what is shown, with its unit, by number of objects."""
    whole = {count: steps["whole run"] for count, steps in counts.items()}
    return {
        "whole run": ("s", {count: one["seconds"] for count, one in whole.items()}),
        "the same, of processors": ("s", {count: one["processor_s"] for count, one in whole.items()}),
        "looking, touching, describing": ("s", _sums(whole, OBJECTS)),
        "recognition and frontier": ("s", _sums(whole, LEARNING)),
        "report": ("s", {count: one["report"]["seconds"] for count, one in counts.items()}),
        "nothing to do": ("s", {count: one["nothing to do"]["seconds"] for count, one in counts.items()}),
        "memory of all processes": ("MB", {count: one["memory_mb"] for count, one in whole.items()}),
        "files": ("MB", {count: one["results_mb"] for count, one in whole.items()}),
    }  # fmt: skip


def _sums(whole: Mapping[int, Mapping[str, float]], names: tuple[str, ...]) -> dict[int, float]:
    return {count: sum(one.get(name, 0.0) for name in names) for count, one in whole.items()}


def exponent(values: Mapping[int, float]) -> float:
    """Give the power of the number of objects by which a value grew between the two largest numbers."""
    (few, less), (many, more) = sorted(values.items())[-2:]
    return math.log(more / less) / math.log(many / few)


def table(rows: Mapping[str, tuple[str, dict[int, float]]]) -> str:
    """Write a Markdown table: a column a number of objects, and the exponent."""
    counts = sorted(next(iter(rows.values()))[1])
    lines = [
        f"| | {' | '.join(f'{count:,} objects' for count in counts)} | exponent |",
        "|---" * (len(counts) + 2) + "|",
    ]
    for name, (unit, values) in rows.items():
        cells = [f"{values[count]:,.0f} {unit}" for count in counts]
        lines.append(f"| {name} | {' | '.join(cells)} | {exponent(values):.2f} |")
    return "\n".join(lines)


def draw(rows: Mapping[str, tuple[str, dict[int, float]]]) -> go.Figure:
    """Draw seconds and memory by number of objects, all axes logarithmic."""
    figure = make_subplots(cols=2, subplot_titles=("Seconds", "Memory and files, MB"))
    drawn = [name for name in rows if name != "the same, of processors"]
    for place, name in enumerate(drawn):
        unit, values = rows[name]
        figure.add_trace(
            go.Scatter(
                x=list(values),
                y=list(values.values()),
                mode="lines+markers",
                name=name,
                line={"color": COLOURS[place % len(COLOURS)], "dash": "dot" if place > 3 else "solid"},
                marker={"symbol": SYMBOLS[place % len(SYMBOLS)], "size": 8},
            ),
            1,
            1 if unit == "s" else 2,
        )  # fmt: skip
    figure.update_xaxes(type="log", title_text="objects", tickvals=list(values))
    figure.update_yaxes(type="log", dtick=1)
    figure.update_layout(
        template="simple_white",
        width=1000,
        height=460,
        legend={"orientation": "h", "y": 1.2},
        margin={"l": 60, "r": 20, "t": 90, "b": 50},
    )
    return figure


def main() -> None:
    """Fill the page's table and write the picture."""
    measured = json.loads(MEASURED.read_text(encoding="utf-8"))
    rows = rows_of({int(count): steps for count, steps in measured["counts"].items()})
    fill_page(PAGE, {"growth": table(rows)})
    photograph(draw(rows), PICTURE)


if __name__ == "__main__":
    main()
