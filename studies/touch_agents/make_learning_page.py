"""Fill learning.md and draw its picture from the kept figures: `make readme`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, get_args

from filling import fill_page, points, resized, save_picture, share, table, wrapped
from matplotlib.figure import Figure

from touch_agents.candidates import SENSES, Setting
from touch_agents.learner import TOUCHES
from touch_agents.learning import DIFFERENCES, Cell
from visuohaptic.report.drawing import look, style
from visuohaptic.report.figures import whole_percent
from visuohaptic.studies.keeping import read_figures

HERE = Path(__file__).parent
PAGE = HERE / "learning.md"
PICTURE = HERE / "learning.png"
SETTINGS: tuple[Setting, ...] = get_args(Setting)
LABELS: dict[Cell, str] = {
    ("seeing", True): "seeing, trained",
    ("seeing", False): "seeing, random",
    ("blind", True): "blind, trained",
    ("blind", False): "blind, random",
}
QUESTIONS = ("sight after training", "sight in training")
"""The differences that answer the question of the page."""
Row = Mapping[str, Any]


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    figures, source = read_figures(HERE, "benchmark")
    seconds, (training, tested) = figures["processor_seconds"], figures["objects"]
    return {
        "sentence": wrapped(sentence(figures["differences"])),
        "differences": differences_table(figures["differences"], figures["accuracies"]),
        "measured": wrapped(
            f"Measured on {source.date}, commit {source.commit[:12]}: {training} objects train, {tested} are tested. "
            f"All touches took {seconds['touches']:.0f} processor seconds, training and tests "
            f"{seconds['training and test']:.0f}."
        ),
    }


def sentence(rows: Sequence[Row]) -> str:
    """Answer the question of the page with intervals of new objects, and name the shown differences."""
    found = {(row["setting"], row["name"]): row for row in rows}
    answers = {found[setting, name]["answer"] for name in QUESTIONS for setting in SETTINGS}
    told = {
        name: " and ".join(
            f"{_points(found[setting, name]).replace(' (', ' points (')} on {setting} objects"
            for setting in SETTINGS
        )
        for name in QUESTIONS
    }
    shown = [
        f"{name} on {setting} objects"
        for (setting, name), row in found.items()
        if row["answer"] == "yes"
    ]
    first = answers.pop().capitalize() if len(answers) == 1 else "It depends"
    return (
        f"**{first}: after training, the agent that sees is ahead of the blind agent by {told[QUESTIONS[0]]}; "
        f"with sight training gains more than without, by {told[QUESTIONS[1]]}.** "
        f"Shown after Holm's correction: {', '.join(shown) or 'no difference'}."
    )


def differences_table(rows: Sequence[Row], accuracies: Sequence[Row]) -> str:
    """Write each difference with the two means that it compares, its p value and the answer."""
    means: dict[str, dict[Cell, float]] = {setting: {} for setting in SETTINGS}
    for row in accuracies:
        if row["touches"] == "mean":
            cell = row["senses"], row["trained"]
            means[row["setting"]][cell] = row["accuracy"]["objects"]["mean"]
    return table(
        ["objects", "difference", "from", "to", "points", "Holm's p", "answer"],
        [
            [
                row["setting"],
                row["name"],
                *_compared(DIFFERENCES[row["name"]], means[row["setting"]]),
                _points(row),
                f"{row['corrected']:.2g}",
                row["answer"],
            ]
            for row in rows
        ],
    )


def _compared(signs: Mapping[Cell, int], means: Mapping[Cell, float]) -> tuple[str, str]:
    """Write the two means that a difference compares; of a difference of gains, both gains."""
    if len(signs) > 2:
        blind, seeing = (
            means[senses, True] - means[senses, False] for senses in ("blind", "seeing")
        )
        return points(blind), points(seeing)
    by_sign = {sign: means[cell] for cell, sign in signs.items()}
    return share(by_sign[-1]), share(by_sign[1])


def _points(row: Row) -> str:
    """Write a difference in points with the interval of new objects."""
    found = row["comparison"]["difference"]
    return f"{points(found['mean'])} ({points(found['low'])} to {points(found['high'])})"


@style()
def draw(rows: Sequence[Row]) -> Figure:
    """Draw accuracy against touches, one column per setting, with the intervals of trained agents."""
    figure = Figure(layout="constrained")
    panels = figure.subplots(1, len(SETTINGS), sharey=True)
    counts = range(1, TOUCHES + 1)
    for panel, setting in zip(panels, SETTINGS, strict=True):
        panel.set_title(f"objects {setting}", fontsize=9.5)
        panel.set_xlabel("touches")
        for (senses, trained), label in LABELS.items():
            colour, mark = look(SENSES.index(senses))
            found = {
                row["touches"]: row["accuracy"]["objects"]
                for row in rows
                if (row["setting"], row["senses"], row["trained"]) == (setting, senses, trained)
            }
            line, low, high = (
                [found[str(count)][end] for count in counts] for end in ("mean", "low", "high")
            )
            dashes = "-" if trained else "--"
            panel.plot(counts, line, dashes, color=colour, marker=mark, markersize=4, label=label)
            if trained:
                panel.fill_between(counts, low, high, color=colour, alpha=0.12, linewidth=0)
        panel.set_xticks(counts)
    panels[0].set_ylabel("correctly classified")
    panels[0].yaxis.set_major_formatter(whole_percent)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower left", ncols=2)
    return resized(figure, 284)


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(read_figures(HERE, "benchmark")[0]["accuracies"]), PICTURE)
