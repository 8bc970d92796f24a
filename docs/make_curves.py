"""Fill the table of docs/probing.md and draw docs/pictures/curves.png from kept figures of study curves.

docs/figures/curves_paper.json and curves_benchmark.json hold what the page takes of reports/studies/curves.json and
reports/curves.json, of the paper's twelve objects and of the catalogue's 142, with the command that gives them and the
date. `python docs/make_curves.py paper COMMAND` keeps those of the run that is there.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from kept_figures import SETS, commands, keep_figures, kept_figures
from make_claims import CLASSIFIER, PIPELINES
from make_readings import points, share
from make_readme import fill_page
from matplotlib.axes import Axes
from matplotlib.figure import Figure

DOCS = Path(__file__).parent
REPORTS = DOCS.parent / "reports"
PAGE = DOCS / "probing.md"
PICTURE = DOCS / "pictures" / "curves.png"
SHOWN = (1, 2, 3, 5, 8, 16)
"""Touches of the table."""
OF_A_POINT = ("accuracy", "low", "high")
TITLES = {"paper": "the paper's pipeline", "best": "ours"}
COLOURS = (
    *("#0b57a4", "#a34a00", "#5c2a86", "#3d5c1e", "#b0182b"),
    *("#00737a", "#8a6d00", "#555555", "#c2185b"),
)

Figures = Mapping[str, Any]
"""``curves`` and ``needed``, by pipeline and strategy, with the command and the date."""


def figures_of_run() -> Figures:
    """Give what the page takes of the run that is there."""
    measured = json.loads((REPORTS / "studies" / "curves.json").read_text("utf-8"))
    needed = json.loads((REPORTS / "curves.json").read_text("utf-8"))
    return {
        "curves": {
            pipeline: {
                strategy: [
                    [cell[value] for value in OF_A_POINT] for cell in found[CLASSIFIER].values()
                ]
                for strategy, found in measured[pipeline].items()
            }
            for pipeline in PIPELINES
        },
        "needed": {
            pipeline: {name: found[CLASSIFIER] for name, found in needed[pipeline].items()}
            for pipeline in PIPELINES
        },
    }


def curve_table(figures: Figures) -> str:
    """Set accuracy by touches, the largest area first, and what fixation gains in area."""
    lines = [
        f"| pipeline | strategy | {' | '.join(map(str, SHOWN))} | touches for 90 % | fixation's area is larger by |",
        "|---|---|" + "---|" * (len(SHOWN) + 2),
    ]
    for pipeline in PIPELINES:
        needed = figures["needed"][pipeline]
        for strategy in sorted(needed, key=lambda name: -needed[name]["area"]):
            curve, row = figures["curves"][pipeline][strategy], needed[strategy]
            cells = [share(curve[touches - 1][0]) for touches in SHOWN]
            touches = "never" if row["touches"] is None else str(row["touches"])
            lines.append(
                f"| {TITLES[pipeline]} | `{strategy}` | {' | '.join(cells)} | {touches} | {gain(row)} |"
            )
    return "\n".join(lines)


def gain(row: Mapping[str, Any]) -> str:
    """Write what fixation gains in area under the curve, in percentage points; nothing for fixation itself."""
    if row["gain"] is None:
        return ""
    ends = f"{points(row['gain_low'])} to {points(row['gain_high'])}"
    return f"{points(row['gain'])} ({ends}), p {row['p_value']:.2g}"


def draw(sets: Mapping[str, Figures]) -> Figure:
    """Draw accuracy against touches: a column a set, a row a pipeline."""
    figure = Figure(figsize=(5.4 * len(sets), 8.4), layout="constrained")
    axes = figure.subplots(len(PIPELINES), len(sets), sharex=True, squeeze=False)
    strategies = sorted({name for one in sets.values() for name in one["needed"]["best"]})
    colours = dict(zip(strategies, COLOURS, strict=False))
    for column, (name, figures) in enumerate(sets.items()):
        for row, pipeline in enumerate(PIPELINES):
            draw_curves(axes[row, column], figures["curves"][pipeline], colours)
            axes[row, column].set_title(f"{SETS[name]}, {TITLES[pipeline]}")
        axes[-1, column].set_xlabel("touches")
    for row in axes:
        row[0].set_ylabel("correctly classified, %")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure


def draw_curves(
    axes: Axes, curves: Mapping[str, list[list[float]]], colours: Mapping[str, str]
) -> None:
    """Draw a line a strategy, and the interval of fixation."""
    for strategy, colour in colours.items():
        line = [100 * point[0] for point in curves[strategy]]
        is_fixation = strategy == "fixation"
        axes.plot(
            range(1, len(line) + 1), line, color=colour, label=strategy,
            linewidth=2.4 if is_fixation else 1.2, marker="o", markersize=3,
        )  # fmt: skip
        if is_fixation:
            low, high = ([100 * point[end] for point in curves[strategy]] for end in (1, 2))
            axes.fill_between(range(1, len(line) + 1), low, high, color=colour, alpha=0.12)
    axes.grid(alpha=0.3)


def blocks() -> dict[str, str]:
    """Give the tables of the page, by the names of their blocks."""
    sets = kept_figures("curves")
    tables = {f"curves_{name}": curve_table(one) for name, one in sets.items()}
    return {**tables, "commands": commands(sets)}


def main() -> None:
    """Keep figures if they are named, fill all blocks, and write the picture."""
    if len(sys.argv) > 2:
        keep_figures("curves", sys.argv[1], " ".join(sys.argv[2:]), figures_of_run())
    fill_page(PAGE, blocks())
    draw(kept_figures("curves")).savefig(PICTURE, dpi=100)


if __name__ == "__main__":
    main()
