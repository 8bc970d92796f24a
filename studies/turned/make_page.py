"""Fill the tables of README.md from the kept accuracies, and draw its picture: `make readme` and `make turned`."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping
from pathlib import Path

import matplotlib.pyplot as plt
from filling import COLOURS, fill_page, table
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from turned.kept import HEADLINE_TOUCHES, KNOWN, TurnedSet, read_turned
from turned.rows import (
    FRAMES_OF_POSES,
    CellName,
    TurnedRow,
    contrast,
    curve_rows,
    frame_rows,
    turned_rows,
)
from turned.study import STATISTICS, STRATEGIES, TRAINED_UPRIGHT
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import with_interval
from visuohaptic.report.wording import POSES, classifier_name, percent, points, strategy_name

PAGE = Path(__file__).parent / "README.md"
PICTURE = PAGE.with_name("turned.png")
LONGEST = 20
"""Touches of the longest sequences."""


def compared() -> dict[str, tuple[CellName, CellName]]:
    """Return the pairs of cells by fixation to compare: the first minus the second, by label."""
    five, twenty = HEADLINE_TOUCHES, LONGEST
    ours = CellName("any", "none", five, "fixation")
    turned_full = CellName("any", "full", five, "fixation")
    return {
        "nothing known: with waves over pairs, less without": (
            ours, CellName("any", STATISTICS, five, "fixation"),
        ),
        "nothing known, less all assumed, fitted on turned objects": (ours, turned_full),
        "nothing known, less all assumed, fitted on upright objects": (
            ours, CellName("any", TRAINED_UPRIGHT, five, "fixation"),
        ),
        f"nothing known, less all known ({five} touches)": (
            ours, CellName("none", "full", five, "fixation"),
        ),
        f"nothing known, less all known ({twenty} touches)": (
            CellName("any", "none", twenty, "fixation"),
            CellName("none", "full", twenty, "fixation"),
        ),
    }  # fmt: skip


def blocks() -> dict[str, str]:
    """Return the tables of the page by name of the block."""
    kept, intervals = read_turned(), IntervalParameters()
    sets = sorted(kept, key="paper".__ne__)
    curves = {name: curve_rows(kept[name], intervals) for name in sets}
    heads = ["objects", "pipeline", "pose", "draws", "fixation", "random, in reach"]
    heads += ["random, in sight", "fixation less in reach"]
    headline = [_headline(row) for name in sets for row in turned_rows(kept[name], intervals)]
    known = ["objects", "pose", "known of the frame", "fixation", "random, in reach"]
    known += ["random, in sight", "fixation less in reach", "fixation less in sight"]
    five = [_known(row) for name in sets for row in frame_rows(kept[name], intervals)]
    lengths = sorted({row.touches for name in sets for row in curves[name]})
    by_length = ["objects", "pose", "known of the frame", "touches by"]
    lines = [line for name in sets for line in _curves(curves[name], lengths)]
    sources = ", ".join(
        f"{name}: commit {kept[name].source.commit[:12]}, {kept[name].source.date}" for name in sets
    )
    source = textwrap.fill(f"Measured once and kept; {sources}.", 100, break_on_hyphens=False)
    return {
        "turned": f"{table(heads, headline)}\n\n{source}",
        "frames": table(known, five),
        "lengths": table([*by_length, *(_counted(length) for length in lengths)], lines),
        "compared": table(
            ["by fixation, in pairs over objects", *(f"{_held_out(kept[name])} objects" for name in sets)],
            [
                [label, *(_plain(with_interval(contrast(kept[name], [first], [second], intervals), points)) for name in sets)]
                for label, (first, second) in compared().items()
            ],
        ),
    }  # fmt: skip


def draw(kept: Mapping[str, TurnedSet]) -> Figure:
    """Draw the accuracy against the number of touches, by the known part of the frame."""
    sets = sorted(kept, key="paper".__ne__)
    figure, panels = plt.subplots(
        1, len(sets), figsize=(10, 4.8), sharey=True, layout="constrained"
    )
    for panel, name in zip(panels, sets, strict=True):
        rows = curve_rows(kept[name], IntervalParameters())
        for colour, (turns, known) in zip(COLOURS, FRAMES_OF_POSES, strict=True):
            line = [row for row in rows if (row.turns, row.known) == (turns, known)]
            line.sort(key=lambda row: row.touches)
            _draw_line(panel, line, colour, f"known: {KNOWN[known]}")
        panel.set_title(f"{rows[0].objects} objects")
        panel.set_xscale("log")
        panel.set_xticks([1, 2, 5, 10, 20], ["1", "2", "5", "10", "20"])
        panel.minorticks_off()
        panel.set_xlabel("touches")
        panel.grid(alpha=0.3)
    panels[0].set_ylabel("sequences correctly classified (%)")
    panels[0].set_ylim(0, 102)
    figure.legend(
        *panels[-1].get_legend_handles_labels(),
        loc="outside lower center",
        ncols=len(FRAMES_OF_POSES),
        title="lines: fixation, with interval; dots: random, in sight",
    )
    return figure


def _draw_line(panel: Axes, rows: list[TurnedRow], colour: str, label: str) -> None:
    touches = [row.touches for row in rows]
    means, lows, highs = (
        [100 * getattr(row.fixation, name) for row in rows] for name in ("mean", "low", "high")
    )
    panel.plot(touches, means, color=colour, label=label)
    panel.fill_between(touches, lows, highs, color=colour, alpha=0.12, linewidth=0)
    panel.plot(touches, [100 * row.visible.mean for row in rows], "o", color=colour, markersize=4)


def _headline(row: TurnedRow) -> list[object]:
    return [
        row.objects,
        f"{row.pipeline}, {classifier_name(row.classifier)}",
        row.pose,
        row.draws,
        *(
            _plain(with_interval(accuracy, percent))
            for accuracy in (row.fixation, row.random, row.visible)
        ),
        _plain(with_interval(row.lead, points)),
    ]


def _known(row: TurnedRow) -> list[object]:
    return [
        row.objects,
        row.pose,
        KNOWN[row.known],
        *(
            _plain(with_interval(accuracy, percent))
            for accuracy in (row.fixation, row.random, row.visible)
        ),
        *(_plain(with_interval(lead, points)) for lead in (row.lead, row.saliency_gain)),
    ]


def _curves(rows: list[TurnedRow], lengths: list[int]) -> Iterator[list[object]]:
    """Yield one row per pose, frame and strategy, with the mean at each number of touches."""
    cells = {(row.turns, row.known, row.touches): row for row in rows}
    fields = dict(zip(("fixation", "random", "visible"), STRATEGIES, strict=True))
    for turns, known in dict.fromkeys((row.turns, row.known) for row in rows):
        curve = [cells[turns, known, touches] for touches in lengths]
        for name, strategy in fields.items():
            shares = [_plain(percent(getattr(row, name).mean)) for row in curve]
            yield [curve[0].objects, POSES[turns], KNOWN[known], strategy_name(strategy), *shares]


def _counted(touches: int) -> str:
    return f"{touches} touch{'' if touches == 1 else 'es'}"


def _held_out(kept: TurnedSet) -> int:
    return int(kept.held_out.sum())


def _plain(text: str) -> str:
    return text.replace("\N{NO-BREAK SPACE}", " ")


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    draw(read_turned()).savefig(PICTURE, dpi=100)
