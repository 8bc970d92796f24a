"""Fill the table of docs/scaling.md and draw docs/pictures/scaling.png from benchmarks/scaling.json.

`python -m benchmarks.many_objects FOLDER` measures; its FOLDER/measured.json is kept as benchmarks/scaling.json.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from filling import COLOURS, DOCS, fill_page, read_json, table
from matplotlib.figure import Figure

MEASURED = DOCS.parent / "benchmarks" / "scaling.json"
PAGE, PICTURE = DOCS / "scaling.md", DOCS / "pictures" / "scaling.png"
LEARNING = ("recognition_s", "study_block_s")
OBJECTS = ("meshes_s", "fixations_s", "touches_s", "features_s", "stability_s")
Steps = Mapping[str, Mapping[str, float]]
Rows = Mapping[str, tuple[str, dict[int, float]]]


def rows_of(counts: Mapping[int, Steps]) -> Rows:
    """Give what is shown, with its unit, by number of objects."""
    whole = {count: steps["whole run"] for count, steps in counts.items()}
    return {
        "whole run": ("s", {count: one["seconds"] for count, one in whole.items()}),
        "whole run, processor time": ("s", {count: one["processor_s"] for count, one in whole.items()}),
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


def growth(rows: Rows) -> str:
    """Write a Markdown table: a column a number of objects, and the exponent."""
    counts = sorted(next(iter(rows.values()))[1])
    lines = [
        [name, *(f"{values[count]:,.0f} {unit}" for count in counts), f"{exponent(values):.2f}"]
        for name, (unit, values) in rows.items()
    ]
    return table(["", *(f"{count:,} objects" for count in counts), "exponent"], lines)


def draw(rows: Rows) -> Figure:
    """Draw seconds and memory by number of objects, all axes logarithmic."""
    figure = Figure(figsize=(10, 4.6), layout="constrained")
    panels = dict(zip(("s", "MB"), figure.subplots(1, 2), strict=True))
    drawn = [name for name in rows if name != "whole run, processor time"]
    for place, name in enumerate(drawn):
        unit, values = rows[name]
        panels[unit].loglog(
            values.keys(), values.values(), label=name, color=COLOURS[place % 4],
            marker="osDX"[place % 4], linestyle=":" if place > 3 else "-",
        )  # fmt: skip
    for panel, title in zip(panels.values(), ("Seconds", "Memory and files, MB"), strict=True):
        panel.set_title(title)
        panel.set_xlabel("objects")
        panel.set_xticks(list(values), [f"{count:,}" for count in values])
        panel.minorticks_off()
    figure.legend(loc="outside upper center", ncols=4)
    return figure


if __name__ == "__main__":
    counts = read_json(MEASURED)["counts"]
    rows = rows_of({int(count): steps for count, steps in counts.items()})
    fill_page(PAGE, {"growth": growth(rows)})
    draw(rows).savefig(PICTURE, dpi=100)
