"""Fill the tables of README.md and draw its picture from the kept figures of this study."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from filling import (
    COLOURS,
    SETS,
    STRATEGIES,
    Figures,
    accuracy,
    difference,
    figures_of_study,
    fill_from_figures,
    measured,
    table,
)
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eye_and_touch.sensing import ADAPTIVE, BLIND
from eye_and_touch.sensing import STRATEGIES as COMPARED
from eye_and_touch.study import (
    CHECKED,
    LOOK,
    PRODUCT,
    SIDE_BY_SIDE,
    STOPPING,
    TOUCH,
)
from eye_and_touch.summary import FUSED

HERE = Path(__file__).parent
PAGE = HERE / "README.md"
PICTURE = HERE / "eye_and_touch.png"
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
COLOUR_OF = dict(zip(WORDS, COLOURS, strict=True))
ROWS_OF_BUDGET = (LOOK, TOUCH, CHECKED, STOPPING)


def sight_table(sets: Mapping[str, Figures]) -> str:
    """Write the table of accuracy and calibration error of every answer, one row per set and sight."""
    shown = [answer for answer in ANSWERS if answer != STOPPING]
    rows = []
    for name, figures in sets.items():
        for row in figures["sights"]:
            cells = [row["answers"][answer] for answer in shown]
            texts = (f"{accuracy(cell)}; {100 * cell['calibration_error']:.0f}" for cell in cells)
            rows.append([SETS[name], row["sight"], *texts])
    return table(["objects", "sight", *(ANSWERS[answer] for answer in shown)], rows)


def gain_table(sets: Mapping[str, Figures]) -> str:
    """Write the table of paired gains: both senses over the better sense, and touch over looking."""
    rows = []
    for name, figures in sets.items():
        for row in figures["sights"]:
            gains = [row["gains"][answer] for answer in (*FUSED, TOUCH)]
            rows.append([SETS[name], row["sight"], ANSWERS[gains[0]["over"]], *map(gain, gains)])
    fused = (ANSWERS[answer] for answer in FUSED)
    return table(["objects", "sight", "the better sense", *fused, "touch over looking"], rows)


def budget_table(sets: Mapping[str, Figures]) -> str:
    """Write one table per set of the accuracy within each budget of the robot's time."""
    tables = []
    for name, figures in sets.items():
        budgets = figures["prices"]["budgets"]
        row_of = {
            (row["budget"], row["answer"], row["strategy"]): row for row in figures["budgets"]
        }
        rows = []
        for answer in ROWS_OF_BUDGET:
            for strategy in dict.fromkeys(key[2] for key in row_of if key[1] == answer):
                words = ", ".join(filter(None, (ANSWERS[answer], WORDS.get(strategy))))
                cells = (budget_cell(row_of.get((budget, answer, strategy))) for budget in budgets)
                rows.append([words, *cells])
        tables.append(table([SETS[name], *(f"{budget:g} s" for budget in budgets)], rows))
    return "\n\n".join(tables)


def budget_cell(row: Figures | None) -> str:
    """Write an accuracy with its interval, and the number of touches or the mean time of the rule."""
    if row is None:
        return ""
    if row["answer"] != STOPPING:
        return f"{accuracy(row)}; {row['touches']}"
    against = f"; {gain(row['gain'])}" if "gain" in row else ""
    return f"{accuracy(row)}; {row['seconds']:.1f} s{against}"


def worth_table(sets: Mapping[str, Figures]) -> str:
    """Write the table of the gain per second of touching after a look, and of the price at which a touch pays."""
    rows = []
    for name, figures in sets.items():
        for row in figures["worth"]:
            rise = 100 * row["accuracy_a_second"]
            price = f"more than {1 / rise:.2g} s" if rise > 0 else "never"
            rows.append([SETS[name], row["sight"], row["touches"], f"{rise:.2f}", price])
    bring = ("points per second of touching", "a touch pays where a point is worth")
    return table(["objects", "sight", "touches", *bring], rows)


def gain(row: Figures) -> str:
    """Write a paired difference in percentage points, with interval and p value."""
    return difference(row, "difference", "low", "high", "p_value")


def draw(sets: Mapping[str, Figures]) -> Figure:
    """Draw accuracy against the robot's time, and accuracy in every sight; one column per set."""
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
    looks = _line(figures["curves"], LOOK)
    for strategy, words in WORDS.items():
        if touches := _line(figures["curves"], CHECKED, strategy):
            line = zip(*sorted([*looks, *touches]), strict=True)
            label = f"look, then touch: {words}"
            axes.plot(*line, marker="o", markersize=3, color=COLOUR_OF[strategy], label=label)
    blind = _line(figures["curves"], TOUCH, BLIND)
    style: dict[str, Any] = {"color": COLOUR_OF[BLIND], "label": f"touch alone: {WORDS[BLIND]}"}
    axes.plot(*zip(*blind, strict=True), linestyle="--", marker="x", markersize=4, **style)
    rule = COMPARED[0]
    stops = _line(figures["budgets"], STOPPING, rule)
    style = {"color": COLOUR_OF[rule], "label": f"the rule that stops: {WORDS[rule]}"}
    axes.plot(*zip(*stops, strict=True), linestyle="none", marker="D", fillstyle="none", **style)
    axes.set_xscale("log")
    ticks = (0.5, 1, 2, 5, 10, 20, 40)
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    axes.set_xlabel("the robot's time, s")
    axes.grid(alpha=0.3)


def _line(
    rows: list[Figures], answer: str, strategy: str | None = None
) -> list[tuple[float, float]]:
    """Return (time, accuracy in percent) of the rows of an answer, and of one strategy if given."""
    return sorted(
        (row["seconds"], 100 * row["accuracy"])
        for row in rows
        if row["answer"] == answer and strategy in {None, row["strategy"]}
    )


def _draw_sights(axes: Axes, figures: Figures) -> None:
    answers = (LOOK, TOUCH, PRODUCT, CHECKED)
    sights = [row["sight"] for row in figures["sights"]]
    for index, answer in enumerate(answers):
        cells = [row["answers"][answer] for row in figures["sights"]]
        heights = [100 * cell["accuracy"] for cell in cells]
        ends = [
            [100 * abs(cell["accuracy"] - cell[end]) for cell in cells] for end in ("low", "high")
        ]
        positions = [sight + 0.2 * (index - 1.5) for sight in range(len(sights))]
        style: dict[str, Any] = {"color": COLOURS[index], "label": ANSWERS[answer]}
        axes.bar(positions, heights, 0.19, yerr=ends, ecolor="#333", **style)
    axes.set_xticks(range(len(sights)), sights)
    axes.set_xlabel(f"sight; {figures['touches']} touches where the eye fixates")


def blocks(sets: Mapping[str, Figures]) -> dict[str, str]:
    """Return the tables of the page by name of the block."""
    return {
        "sights": sight_table(sets),
        "gains": gain_table(sets),
        "budgets": budget_table(sets),
        "worth": worth_table(sets),
        "measured": measured(HERE),
    }


if __name__ == "__main__":
    fill_from_figures(figures_of_study(HERE), PAGE, blocks, PICTURE, draw)
