"""Fill the tables of docs/scaling.md and draw docs/pictures/scaling.png from benchmarks/scaling.json.

`python -m benchmarks.many_objects FOLDER` measures; its FOLDER/measured.json is kept as benchmarks/scaling.json.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import chain

from filling import DOCS, fill_page, read_json, table
from matplotlib.figure import Figure

MEASURED = DOCS.parent / "benchmarks" / "scaling.json"
PAGE, PICTURE = DOCS / "scaling.md", DOCS / "pictures" / "scaling.png"
SCRIPTS = {
    "meshes": ("meshes",),
    "fixations": ("fixations",),
    "touches": ("touches",),
    "features": ("features",),
    "recognition": ("recognition",),
    "frontier and effects": (
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


def seconds_of(counts: Mapping[int, Steps]) -> Rows:
    """Return processor seconds by phase and number of objects, with the whole run first."""
    jobs = {
        row: {
            count: sum(steps[script]["processor_s"] for script in scripts if script in steps)
            for count, steps in counts.items()
        }
        for row, scripts in SCRIPTS.items()
    }
    whole = {count: steps[WHOLE]["processor_s"] for count, steps in counts.items()}
    snakemake = {count: whole[count] - sum(row[count] for row in jobs.values()) for count in whole}
    nothing = {count: steps["nothing to do"]["processor_s"] for count, steps in counts.items()}
    return {WHOLE: whole, **jobs, "Snakemake itself": snakemake, "nothing to do": nothing}


def memory_of(counts: Mapping[int, Steps]) -> Rows:
    """Return the peak memory (MB) of the largest job by phase and number of objects, with the whole run first."""
    jobs = {
        row: {
            count: max(steps[script]["memory_mb"] for script in scripts if script in steps)
            for count, steps in counts.items()
        }
        for row, scripts in SCRIPTS.items()
    }
    whole = {count: steps[WHOLE]["memory_mb"] for count, steps in counts.items()}
    files = {count: steps[WHOLE]["results_mb"] for count, steps in counts.items()}
    return {f"{WHOLE}, all processes": whole, **jobs, "files of results": files}


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


if __name__ == "__main__":
    measured = read_json(MEASURED)["counts"]
    counts = {int(count): steps for count, steps in measured.items()}
    seconds, memory = seconds_of(counts), memory_of(counts)
    fill_page(PAGE, {"seconds": growth(seconds, "s"), "memory": growth(memory, "MB")})
    panels = {"Processor seconds": seconds, "Peak memory of the largest job, MB": memory}
    draw(panels).savefig(PICTURE, dpi=100)
