"""Fill README.md and draw its picture from the kept figures: `make readme`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from filling import estimated, fill_page, points, save_picture, table, wrapped
from matplotlib.figure import Figure

from touch_agents.measure import CHOOSERS, FRAMES, TOUCHES
from visuohaptic.evaluation.intervals import holm
from visuohaptic.report.drawing import INCH, look, style
from visuohaptic.report.estimates import Figure as Estimate
from visuohaptic.report.figures import whole_percent
from visuohaptic.studies.keeping import read_figures

HERE = Path(__file__).parent
PAGE = HERE / "README.md"
PICTURE = HERE / "curves.png"
LABELS = {
    "random": "random, in reach",
    "random_visible": "random, in sight",
    "fixation": "fixations in order",
    "seek_relief": "`seek_relief`",
}
IN_TABLE = (1, 5)
COMPARED = (1, 2, 3, 5)
"""Numbers of touches of the compared leads."""
DRAWN = {"full": "the whole pose known", "none": "nothing known of the pose"}
LEVEL = 0.05
Row = Mapping[str, Any]


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    rows, source = read_figures(HERE, "paper")
    cells = {(row["frame"], row["touches"], row["chooser"]): _cell(row) for row in rows}
    return {
        "leads": wrapped(lead_sentence(rows)),
        "figures": table(
            ["frame", "touches", *LABELS.values()],
            [
                [frame, count, *(cells[frame, count, name] for name in CHOOSERS)]
                for frame in FRAMES
                for count in IN_TABLE
            ],
        ),
        "measured": f"Measured on {source.date}, commit {source.commit[:12]}.",
    }


def lead_sentence(rows: Sequence[Row]) -> str:
    """Return how many leads over random places in reach stand, and the largest lead."""
    leads = [row for row in rows if row["chooser"] != "random" and row["touches"] in COMPARED]
    adjusted = holm([row["accuracy lead"]["p_value"] for row in leads])
    largest = max(leads, key=lambda row: row["accuracy lead"]["difference"]["mean"])
    found = largest["accuracy lead"]["difference"]
    return (
        f"Of {len(leads)} leads over random places in reach, {sum(p < LEVEL for p in adjusted)} stand after Holm's "
        f"correction (p below {LEVEL}). The largest is {points(found['mean'])} points ({points(found['low'])} to "
        f"{points(found['high'])}, not corrected): {LABELS[largest['chooser']]}, frame `{largest['frame']}`, "
        f"{largest['touches']} touch{'es' if largest['touches'] > 1 else ''}."
    )


def _cell(row: Row) -> str:
    loss = row["loss"]["objects"]["mean"]
    return f"{estimated(Estimate(**row['accuracy']['objects']))}; {loss:.2f}"


@style()
def draw(rows: Sequence[Row]) -> Figure:
    """Draw accuracy and loss against touches, one column per frame, with intervals of random places in reach."""
    figure = Figure(figsize=(500 / INCH, 420 / INCH), layout="constrained")
    axes = figure.subplots(2, len(DRAWN), sharex=True, sharey="row")
    for column, (frame, words) in enumerate(DRAWN.items()):
        axes[0, column].set_title(words, fontsize=9.5)
        axes[1, column].set_xlabel("touches")
        for place, name in enumerate(CHOOSERS):
            colour, mark = look(place)
            own = [row for row in rows if (row["frame"], row["chooser"]) == (frame, name)]
            for panel, value in zip(axes[:, column], ("accuracy", "loss"), strict=True):
                found = [row[value]["objects"] for row in own]
                line, low, high = ([one[end] for one in found] for end in ("mean", "low", "high"))
                label = LABELS[name].strip("`")
                panel.plot(TOUCHES, line, color=colour, marker=mark, markersize=4, label=label)
                if name == "random":
                    panel.fill_between(TOUCHES, low, high, color=colour, alpha=0.12, linewidth=0)
        axes[1, column].set_xticks(TOUCHES)
        axes[1, column].axhline(1, color="black", linestyle="--", linewidth=1)
    axes[0, 0].set_ylabel("correctly classified")
    axes[0, 0].yaxis.set_major_formatter(whole_percent)
    axes[1, 0].set_ylabel("loss (dashed: a blind guess)")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower left", ncols=2)
    return figure


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(read_figures(HERE, "paper")[0]), PICTURE)
