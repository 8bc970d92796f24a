"""Fill the tables of docs/scaling.md and draw docs/pictures/scaling.png from benchmarks/scaling.json.

`python -m benchmarks.many_objects FOLDER` measures; its FOLDER/measured.json is kept as benchmarks/scaling.json.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from itertools import chain

from filling import DOCS, fill_page, read_json, table, wrapped
from matplotlib.figure import Figure

MEASURED = DOCS.parent / "benchmarks" / "scaling.json"
PAGE, PICTURE = DOCS / "scaling.md", DOCS / "pictures" / "scaling.png"
SCRIPTS = {
    "meshes": ("meshes",),
    "fixations": ("fixations",),
    "touches": ("touches",),
    "features": ("features",),
    "recognition": ("recognition",),
    "frontier, draws and effects": (
        "block_of_study",
        "features_of_study",
        "figures_of_study",
        "study_step",
    ),
    "stability": ("stability_of_object",),
    "pictures": ("pictures",),
    "report and metrics": ("report", "metrics"),
}
"""By row of the tables, the scripts of its jobs, which benchmarks/scaling.json has by name."""

WHOLE = "whole run"
MARKERS = "osDXv^<>Ph*"
Steps = Mapping[str, Mapping[str, float]]
Rows = Mapping[str, Mapping[int, float]]


def of_scripts(
    counts: Mapping[int, Steps], quantity: str, combine: Callable[[Iterable[float]], float]
) -> Rows:
    """Return one quantity by row of `SCRIPTS` and number of objects, combined over the scripts of a row."""
    return {
        row: {
            count: combine(steps[script][quantity] for script in scripts if script in steps)
            for count, steps in counts.items()
        }
        for row, scripts in SCRIPTS.items()
    }


def of_step(counts: Mapping[int, Steps], step: str, quantity: str) -> Mapping[int, float]:
    """Return one quantity of a step by number of objects."""
    return {count: steps[step][quantity] for count, steps in counts.items()}


def seconds_of(counts: Mapping[int, Steps]) -> Rows:
    """Return processor seconds by phase and number of objects, with the whole run first and wall-clock seconds last."""
    jobs, whole = of_scripts(counts, "processor_s", sum), of_step(counts, WHOLE, "processor_s")
    return {
        WHOLE: whole,
        **jobs,
        "Snakemake itself": {
            count: seconds - sum(row[count] for row in jobs.values())
            for count, seconds in whole.items()
        },
        "nothing to do": of_step(counts, "nothing to do", "processor_s"),
        f"{WHOLE}, wall clock": of_step(counts, WHOLE, "seconds"),
    }


def memory_of(counts: Mapping[int, Steps]) -> Rows:
    """Return the peak memory (MB) of the largest job by phase and number of objects, with the whole run first."""
    return {
        f"{WHOLE}, all processes": of_step(counts, WHOLE, "memory_mb"),
        **of_scripts(counts, "memory_mb", max),
        "files of results": of_step(counts, WHOLE, "results_mb"),
    }


def exponent(values: Mapping[int, float]) -> float:
    """Return the power of the number of objects by which a value grew between the two largest numbers."""
    (few, less), (many, more) = sorted(values.items())[-2:]
    return math.log(more / less) / math.log(many / few)


def growth(rows: Rows, unit: str) -> str:
    """Write a Markdown table with a column per number of objects, and the exponent."""
    counts = sorted(next(iter(rows.values())))
    lines = [
        [name, *(f"{values[count]:,.0f} {unit}" for count in counts), f"{exponent(values):.2f}"]
        for name, values in rows.items()
    ]
    return table(["", *(f"{count:,} objects" for count in counts), "exponent"], lines)


def largest(seconds: Rows) -> str:
    """Name the three phases that take the most processor seconds with the largest number of objects."""
    count = max(seconds[WHOLE])
    costs = sorted(((seconds[row][count], row) for row in SCRIPTS), reverse=True)[:3]
    named = "; ".join(f"{row}, {cost:,.0f} s" for cost, row in costs)
    return wrapped(f"Most processor time with {count:,} objects: {named}.")


def draw(panels: Mapping[str, Rows]) -> Figure:
    """Draw one panel per table by number of objects, all axes logarithmic, and lines of exponent 1 for comparison."""
    figure = Figure(figsize=(11, 5.6), layout="constrained")
    names = list(dict.fromkeys(chain.from_iterable(panels.values())))
    style = {
        name: {"color": f"C{place % 10}", "marker": MARKERS[place % len(MARKERS)]}
        for place, name in enumerate(names)
    }
    axes = figure.subplots(1, len(panels))
    for panel, (title, rows) in zip(axes, panels.items(), strict=True):
        for name, values in rows.items():
            width = 2.4 if name.startswith(WHOLE) else 1.1
            panel.loglog(
                values.keys(), values.values(), label=name, linewidth=width, markersize=4, **style[name]
            )  # fmt: skip
        counts = list(next(iter(rows.values())))
        low, high = panel.get_ylim()
        for start in (10.0**power for power in range(-3, 5)):
            panel.plot(counts, [start * count for count in counts], color="#dddddd", zorder=0)
        panel.set_ylim(low, high)
        panel.set_title(title)
        panel.set_xlabel("objects")
        panel.set_xticks(counts, [f"{count:,}" for count in counts])
        panel.minorticks_off()
    handles = {
        label: handle
        for panel in axes
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True)
    }
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=5)
    return figure


def read_rows() -> tuple[Rows, Rows]:
    """Return the kept `seconds_of` and `memory_of`."""
    counts = {int(count): steps for count, steps in read_json(MEASURED)["counts"].items()}
    return seconds_of(counts), memory_of(counts)


def blocks() -> dict[str, str]:
    """Return the tables and the sentence of the page by name of the block."""
    seconds, memory = read_rows()
    return {
        "seconds": growth(seconds, "s"),
        "memory": growth(memory, "MB"),
        "largest": largest(seconds),
    }


if __name__ == "__main__":
    seconds, memory = read_rows()
    fill_page(PAGE, blocks())
    panels = {
        "Processor seconds, and wall clock of the whole run": seconds,
        "Peak memory of the largest job, MB": memory,
    }
    draw(panels).savefig(PICTURE, dpi=100)
