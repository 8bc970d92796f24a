"""Fill the tables of README.md and draw its curves from the kept figures: `make readme`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from filling import COLOURS, fill_page, points, table

from touch_agents.measure import CHOOSERS, FRAMES, TOUCHES
from visuohaptic.studies.keeping import read_figures

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HERE = Path(__file__).parent
PAGE = HERE / "README.md"
PICTURE = HERE / "curves.png"
LABELS = {
    "random": "random, in reach",
    "random_visible": "random, in sight",
    "fixation": "fixations in order",
    "seek_relief": "`seek_relief`",
}
SHOWN = (1, 2, 3, 5)
Row = Mapping[str, Any]


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    rows, source = read_figures(HERE, "paper")
    shown = [row for row in rows if row["touches"] in SHOWN]
    heads = ["frame", "touches after", *LABELS.values()]
    leads = [row for row in shown if row["chooser"] != "random"]
    return {
        "accuracy": table(heads, _table(shown, _accuracy)),
        "loss": table(heads, _table(shown, _loss)),
        "leads": table([*heads[:2], *list(LABELS.values())[1:]], _table(leads, _lead)),
        "measured": f"Measured on {source.date}, commit {source.commit[:12]}.",
    }


def _table(rows: Sequence[Row], cell: Any) -> list[list[str]]:
    """Return one row per frame and number of touches, with a cell per chooser."""
    cells = {(row["frame"], row["touches"], row["chooser"]): cell(row) for row in rows}
    return [
        [
            frame,
            str(count),
            *(cells[frame, count, name] for name in CHOOSERS if (frame, count, name) in cells),
        ]
        for frame in FRAMES
        for count in SHOWN
    ]


def _accuracy(row: Row) -> str:
    one = row["accuracy"]["objects"]
    return f"{100 * one['mean']:.1f} ({100 * one['low']:.0f}–{100 * one['high']:.0f})"


def _loss(row: Row) -> str:
    one = row["loss"]["objects"]
    return f"{one['mean']:.2f} ({one['low']:.2f}–{one['high']:.2f})"


def _lead(row: Row) -> str:
    found = row["accuracy lead"]
    objects, classes = found["difference"], found["difference_new_classes"]
    ends = "; ".join(f"{points(one['low'])} to {points(one['high'])}" for one in (objects, classes))
    return f"{points(objects['mean'])} ({ends})"


def draw() -> Figure:
    """Draw accuracy and loss against touches, one column per frame, with the interval of random places in reach."""
    from matplotlib.figure import Figure

    rows, _ = read_figures(HERE, "paper")
    figure = Figure(figsize=(10.8, 5.4), layout="constrained")
    axes = figure.subplots(2, len(FRAMES), sharex=True, sharey="row")
    for column, frame in enumerate(FRAMES):
        axes[0, column].set_title(f"frame {frame}")
        axes[1, column].set_xlabel("touches")
        for name, colour in zip(CHOOSERS, COLOURS, strict=True):
            for panel, value, scale in zip(
                axes[:, column], ("accuracy", "loss"), (100, 1), strict=True
            ):
                line, low, high = (
                    [
                        scale * row[value]["objects"][end]
                        for row in rows
                        if (row["frame"], row["chooser"]) == (frame, name)
                    ]
                    for end in ("mean", "low", "high")
                )
                label = LABELS[name].strip("`")
                panel.plot(TOUCHES, line, color=colour, label=label, marker="o", markersize=3)
                if name == "random":
                    panel.fill_between(TOUCHES, low, high, color=colour, alpha=0.12)
                panel.grid(alpha=0.3)
    axes[0, 0].set_ylabel("correctly classified, %")
    axes[1, 0].set_ylabel("loss (1 is a blind guess)")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    draw().savefig(PICTURE, dpi=80)
