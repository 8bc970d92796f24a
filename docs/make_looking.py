"""Fill the tables of docs/looking.md and draw its picture from kept figures of study looking.

docs/figures/looking_paper.json and looking_benchmark.json hold reports/looking.json of the paper's twelve
objects and of the catalogue's 142, with the command that gives them and the date. `python docs/make_looking.py paper COMMAND`
keeps those of the run that is there.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from kept_figures import SETS, commands, keep_figures, kept_figures
from make_claims import STRATEGIES, accuracy
from make_readings import points
from make_readme import fill_page
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from visuohaptic.studies.looking.figures import FUSED
from visuohaptic.studies.looking.sensing import ADAPTIVE, BLIND
from visuohaptic.studies.looking.sensing import STRATEGIES as COMPARED
from visuohaptic.studies.looking.settings import (
    CHECKED,
    LOOK,
    PRODUCT,
    SIDE_BY_SIDE,
    STOPPING,
    TOUCH,
)

DOCS = Path(__file__).parent
PAGE = DOCS / "looking.md"
PICTURE = DOCS / "pictures" / "looking.png"
ANSWERS = {
    LOOK: "look, view",
    "outline": "look, outline",
    TOUCH: "touch",
    PRODUCT: "product",
    CHECKED: "checked product",
    SIDE_BY_SIDE: "side by side",
    STOPPING: "look, then touch by the rule",
}
WORDS = {
    **{name: STRATEGIES[name] for name in COMPARED},
    ADAPTIVE: "largest expected information gain",
}
COLOURS = dict(zip(WORDS, ("#0b57a4", "#a34a00", "#5c2a86", "#3d5c1e"), strict=True))
ROWS_OF_BUDGET = (LOOK, TOUCH, CHECKED, STOPPING)

Figures = Mapping[str, Any]
"""reports/looking.json."""


def sight_table(sets: Mapping[str, Figures]) -> str:
    """Set accuracy and calibration error of every answer, a row a set and sight."""
    shown = [answer for answer in ANSWERS if answer != STOPPING]
    lines = [
        f"| objects | sight | {' | '.join(ANSWERS[answer] for answer in shown)} |",
        "|---|---|" + "---|" * len(shown),
    ]
    for name, figures in sets.items():
        for row in figures["sights"]:
            cells = [
                f"{accuracy(cell)}; {100 * cell['calibration_error']:.0f}"
                for cell in (row["answers"][answer] for answer in shown)
            ]
            lines.append(f"| {SETS[name]} | {row['sight']} | {' | '.join(cells)} |")
    return "\n".join(lines)


def gain_table(sets: Mapping[str, Figures]) -> str:
    """Set what both senses gain over the better of them, and touch over looking, in pairs."""
    lines = [
        "| objects | sight | the better sense | "
        + " | ".join(ANSWERS[answer] for answer in FUSED)
        + " | touch over looking |",
        "|---|---|---|" + "---|" * (len(FUSED) + 1),
    ]
    for name, figures in sets.items():
        for row in figures["sights"]:
            gains = [row["gains"][answer] for answer in (*FUSED, TOUCH)]
            better = ANSWERS[gains[0]["over"]]
            lines.append(
                f"| {SETS[name]} | {row['sight']} | {better} | {' | '.join(map(gain, gains))} |"
            )
    return "\n".join(lines)


def budget_table(sets: Mapping[str, Figures]) -> str:
    """Set accuracy within each budget of a robot's time."""
    lines = []
    for name, figures in sets.items():
        budgets = figures["prices"]["budgets"]
        lines += [
            *([""] if lines else []),
            f"| {SETS[name]} | {' | '.join(f'{budget:g} s' for budget in budgets)} |",
            "|---|" + "---|" * len(budgets),
        ]
        found = {(row["budget"], row["answer"], row["strategy"]): row for row in figures["budgets"]}
        for answer in ROWS_OF_BUDGET:
            for strategy in dict.fromkeys(key[2] for key in found if key[1] == answer):
                cells = [budget_cell(found.get((one, answer, strategy))) for one in budgets]
                words = ", ".join(filter(None, (ANSWERS[answer], WORDS.get(strategy))))
                lines.append(f"| {words} | {' | '.join(cells)} |")
    return "\n".join(lines)


def budget_cell(row: Mapping[str, Any] | None) -> str:
    """Write an accuracy with its interval, and the number of touches or the mean time of the rule."""
    if row is None:
        return ""
    if row["answer"] != STOPPING:
        return f"{accuracy(row)}; {row['touches']}"
    against = f"; {gain(row['gain'])}" if "gain" in row else ""
    return f"{accuracy(row)}; {row['seconds']:.1f} s{against}"


def worth_table(sets: Mapping[str, Figures]) -> str:
    """Set what a second of touching brings after a look, and from which price on a touch pays."""
    lines = [
        "| objects | sight | touches | points a second of touching | a touch pays where a point is worth |",
        "|---|---|---|---|---|",
    ]
    for name, figures in sets.items():
        for row in figures["worth"]:
            rise = 100 * row["accuracy_a_second"]
            price = f"more than {1 / rise:.2g} s" if rise > 0 else "never"
            lines.append(
                f"| {SETS[name]} | {row['sight']} | {row['touches']} | {rise:.2f} | {price} |"
            )
    return "\n".join(lines)


def gain(found: Mapping[str, Any]) -> str:
    """Write a paired difference in percentage points."""
    return (
        f"{points(found['difference'])} ({points(found['low'])} to {points(found['high'])}), "
        f"p {found['p_value']:.2g}"
    )


def draw(sets: Mapping[str, Figures]) -> Figure:
    """Draw accuracy against the robot's time, and accuracy in every sight; a column a set."""
    figure = Figure(figsize=(5.4 * len(sets), 8.4), layout="constrained")
    axes = figure.subplots(2, len(sets), sharey="row", squeeze=False)
    for column, (name, figures) in enumerate(sets.items()):
        _draw_times(axes[0, column], figures)
        axes[0, column].set_title(f"{SETS[name]}, clean sight")
        _draw_sights(axes[1, column], figures)
    for row in axes:
        row[0].set_ylabel("correctly classified, %")
    axes[0, 0].legend(fontsize=7, loc="lower right")
    axes[1, 0].legend(fontsize=7, loc="upper center", ncols=4)
    axes[1, 0].set_ylim(0, 115)
    return figure


def _draw_times(axes: Axes, figures: Figures) -> None:
    for strategy, words in WORDS.items():
        line = sorted(_curve(figures, strategy))
        if not line:
            continue
        style = {"color": COLOURS[strategy], "label": f"look, then touch: {words}"}
        axes.plot(*zip(*line, strict=True), marker="o", markersize=3, **style)
    blind = sorted(
        (row["seconds"], 100 * row["accuracy"])
        for row in figures["curves"]
        if (row["answer"], row["strategy"]) == (TOUCH, BLIND)
    )
    style = {"color": COLOURS[BLIND], "label": f"touch alone: {WORDS[BLIND]}"}
    axes.plot(*zip(*blind, strict=True), linestyle="--", marker="x", markersize=4, **style)
    stops = [
        (row["seconds"], 100 * row["accuracy"])
        for row in figures["budgets"]
        if (row["answer"], row["strategy"]) == (STOPPING, COMPARED[0])
    ]
    style = {"color": COLOURS[COMPARED[0]], "label": f"the rule that stops: {WORDS[COMPARED[0]]}"}
    axes.plot(*zip(*stops, strict=True), linestyle="none", marker="D", fillstyle="none", **style)
    axes.set_xscale("log")
    ticks = (0.5, 1, 2, 5, 10, 20, 40)
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    axes.set_xlabel("the robot's time, s")
    axes.grid(alpha=0.3)


def _curve(figures: Figures, strategy: str) -> Iterator[tuple[float, float]]:
    """Give time and accuracy after a look and after each touch that follows it."""
    rows = [
        row for row in figures["curves"] if (row["answer"], row["strategy"]) == (CHECKED, strategy)
    ]
    looks = [row for row in figures["curves"] if row["answer"] == LOOK] if rows else []
    for row in (*looks, *rows):
        yield row["seconds"], 100 * row["accuracy"]


def _draw_sights(axes: Axes, figures: Figures) -> None:
    answers = (LOOK, TOUCH, PRODUCT, CHECKED)
    sights = [row["sight"] for row in figures["sights"]]
    for place, answer in enumerate(answers):
        cells = [row["answers"][answer] for row in figures["sights"]]
        heights = [100 * cell["accuracy"] for cell in cells]
        ends = [
            [100 * abs(cell["accuracy"] - cell[end]) for cell in cells] for end in ("low", "high")
        ]
        places = [number + 0.2 * (place - 1.5) for number in range(len(sights))]
        colour = list(COLOURS.values())[place]
        axes.bar(
            places, heights, 0.19, yerr=ends, color=colour, label=ANSWERS[answer], ecolor="#333"
        )
    axes.set_xticks(range(len(sights)), sights)
    axes.set_xlabel(f"sight; {figures['touches']} touches where the eye fixates")


def blocks() -> dict[str, str]:
    """Give the tables of the page, by the names of their blocks."""
    sets = kept_figures("looking")
    return {
        "sights": sight_table(sets),
        "gains": gain_table(sets),
        "budgets": budget_table(sets),
        "worth": worth_table(sets),
        "commands": commands(sets),
    }


def main() -> None:
    """Keep figures if they are named, fill all blocks, and write the picture."""
    if len(sys.argv) > 2:
        figures = json.loads((DOCS.parent / "reports" / "looking.json").read_text("utf-8"))
        keep_figures("looking", sys.argv[1], " ".join(sys.argv[2:]), figures)
    fill_page(PAGE, blocks())
    draw(kept_figures("looking")).savefig(PICTURE, dpi=100)


if __name__ == "__main__":
    main()
