"""Fill the tables of README.md and draw curves.png from the kept figures of this study."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from filling import (
    SETS,
    Figures,
    difference,
    figures_of_study,
    fill_from_figures,
    measured,
    share,
    table,
)
from make_claims import of_classifier, pipelines_of
from matplotlib.figure import Figure

HERE = Path(__file__).parent
PAGE = HERE / "README.md"
PICTURE = HERE / "curves.png"
SHOWN = (1, 2, 3, 5, 8, 16)
"""Numbers of touches in the table."""
COLOURS = (
    *("#0b57a4", "#a34a00", "#5c2a86", "#3d5c1e", "#b0182b"),
    *("#00737a", "#8a6d00", "#555555", "#c2185b", "#7cb342"),
)


def title(pipeline: str) -> str:
    """Return the label of a pipeline on the page."""
    return "the paper's pipeline" if pipeline == "paper" else "ours"


def curve_table(figures: Figures) -> str:
    """Write the table of accuracy by touches and of fixation's gain in area, the largest area first."""
    rows = []
    for pipeline in pipelines_of(figures["needed"]):
        needed = figures["needed"][pipeline]
        for strategy in sorted(needed, key=lambda name: -of_classifier(needed[name])["area"]):
            row = of_classifier(needed[strategy])
            curve = of_classifier(figures["curves"][pipeline][strategy])["points"]
            reached = (share(curve[touches - 1][0]) for touches in SHOWN)
            touches = "never" if row["touches"] is None else row["touches"]
            gain = difference(row, "gain", "gain_low", "gain_high", "p_value")
            rows.append([title(pipeline), f"`{strategy}`", *reached, touches, gain])
    after = ("touches for 90 %", "fixation's area is larger by")
    return table(["pipeline", "strategy", *map(str, SHOWN), *after], rows)


def draw(sets: Mapping[str, Figures]) -> Figure:
    """Draw accuracy against touches, with the interval of fixation; one column per set, one row per pipeline."""
    figure = Figure(figsize=(5.4 * len(sets), 8.4), layout="constrained")
    axes = figure.subplots(2, len(sets), sharex=True, squeeze=False)
    strategies = sorted({name for figures in sets.values() for name in figures["needed"]["paper"]})
    for column, (name, figures) in enumerate(sets.items()):
        for panel, pipeline in zip(axes[:, column], pipelines_of(figures["curves"]), strict=True):
            panel.set_title(f"{SETS[name]}, {title(pipeline)}")
            panel.grid(alpha=0.3)
            for strategy, colour in zip(strategies, COLOURS, strict=True):
                points = of_classifier(figures["curves"][pipeline][strategy])["points"]
                line, low, high = (
                    [100 * value for value in values] for values in zip(*points, strict=True)
                )
                touches = range(1, len(line) + 1)
                is_fixation = strategy == "fixation"
                panel.plot(
                    touches, line, color=colour, label=strategy,
                    linewidth=2.4 if is_fixation else 1.2, marker="o", markersize=3,
                )  # fmt: skip
                if is_fixation:
                    panel.fill_between(touches, low, high, color=colour, alpha=0.12)
        axes[-1, column].set_xlabel("touches")
    for row in axes:
        row[0].set_ylabel("correctly classified, %")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure


def blocks(sets: Mapping[str, Figures]) -> dict[str, str]:
    """Return the tables of the page by name of the block."""
    tables = {name: curve_table(figures) for name, figures in sets.items()}
    return {**tables, "measured": measured(HERE)}


if __name__ == "__main__":
    fill_from_figures(figures_of_study(HERE), PAGE, blocks, PICTURE, draw)
