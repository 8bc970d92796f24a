"""Fill README.md and draw its picture from the kept figures: `make readme`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

from filling import (
    figures_of_study,
    fill_page,
    measured,
    resized,
    save_picture,
    share,
    table,
    wrapped,
)
from matplotlib.figure import Figure

from touch_agents.learning import SHOWN
from touch_agents.measure import CHOOSERS, PREDICTORS
from touch_curves.choosing import ADAPTIVE
from visuohaptic.evaluation.intervals import SIGNIFICANCE
from visuohaptic.report.drawing import look, style
from visuohaptic.report.figures import whole_percent

HERE = Path(__file__).parent
KEPT = HERE / "baselines"
PAGE = HERE / "README.md"
PICTURE = HERE / "curves.png"
LABELS = {
    "random": "random, in reach",
    "random_visible": "random, in sight",
    "fixation": "fixations in order",
    "seek_relief": "`seek_relief`",
    "adaptive": "`adaptive`",
}
SETS = {"benchmark": "75 tested objects", "paper": "12 objects"}
IN_TABLE = 5
"""Touches of the table."""
DRAWN = {"full": "the whole pose known", "none": "nothing known"}
"""Frames of the picture and of the table."""
HEADS = {"accuracy": "correctly classified", "loss": "loss"}
SIGNS = {"accuracy": 1, "loss": -1}
"""Sign of a better difference, by measure."""
Row = Mapping[str, Any]


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    figures = figures_of_study(KEPT, SETS)
    of_benchmark = figures["benchmark"]
    twelve = _count(figures["paper"]["differences"], SETS["paper"])
    return {
        "answer": wrapped(answer(of_benchmark["cells"], of_benchmark["differences"])),
        "twelve": wrapped(f"- {twelve}", "  "),
        "figures": figures_table(of_benchmark["cells"]),
        "measured": measured(KEPT, SETS),
    }


def answer(cells: Sequence[Row], rows: Sequence[Row]) -> str:
    """Return the best accuracy and loss of the table, and how many differences are shown."""
    best = ", and ".join(f"{_best(cells, frame)} with {words}" for frame, words in DRAWN.items())
    shown = [row for row in rows if row["corrected"] < SIGNIFICANCE]
    worse = sum(SIGNS[row["measure"]] * _mean(row) < 0 for row in shown)
    leads, gains = (
        [row for row in rows if (row["predictor"] in PREDICTORS) == is_lead]
        for is_lead in (True, False)
    )
    return (
        f"**After five touches an agent has to beat {best}: the best by choosers that know no more than the agent.** "
        f"Leads over random places in reach are shown in {_better(leads)}: {_leaders(leads)}. "
        f"`learned` is shown to be better than `order_free` in {_better(gains)}; {worse} differences are shown to be worse."
    )


def _best(cells: Sequence[Row], frame: str) -> str:
    """Write the highest accuracy and the lowest loss by choosers that an agent of the frame could be."""
    own = [
        row
        for row in cells
        if (row["frame"], row["touches"]) == (frame, IN_TABLE)
        and (frame == "full" or row["chooser"] != ADAPTIVE.name)
    ]
    right = max(own, key=lambda row: float(row["accuracy"]["objects"]["mean"]))
    lost = min(own, key=lambda row: float(row["loss"]["objects"]["mean"]))
    return f"{_accuracy(right)} and a loss of {_loss(lost)}"


def _better(rows: Sequence[Row]) -> str:
    parts = []
    for measure, sign in SIGNS.items():
        own = [row for row in rows if row["measure"] == measure]
        better = sum(row["corrected"] < SIGNIFICANCE and sign * _mean(row) > 0 for row in own)
        parts.append(f"{better} of {len(own)} cases of {measure}")
    return " and ".join(parts)


def _leaders(rows: Sequence[Row]) -> str:
    """Name the choosers and frames of the shown leads."""
    frames: dict[str, list[str]] = {}
    for row in rows:
        if row["corrected"] < SIGNIFICANCE and SIGNS[row["measure"]] * _mean(row) > 0:
            of_chooser = frames.setdefault(LABELS[row["chooser"]], [])
            if (name := f"`{row['frame']}`") not in of_chooser:
                of_chooser.append(name)
    return ", and ".join(f"{name}, in {' and '.join(found)}" for name, found in frames.items())


def _count(rows: Sequence[Row], words: str) -> str:
    shown = sum(row["corrected"] < SIGNIFICANCE for row in rows)
    least = min(row["comparison"]["p_value"] for row in rows)
    return f"On the {words} {shown} of {len(rows)} differences are shown; the smallest p value is {least:.2g} before the correction."


def figures_table(cells: Sequence[Row]) -> str:
    """Write accuracy and loss of each predictor by drawn frame and chooser."""
    found = {(row["frame"], row["touches"], row["chooser"], row["predictor"]): row for row in cells}
    return table(
        [
            *("frame", "chooser"),
            *(f"`{name}`{value}" for name in PREDICTORS for value in ("", ", loss")),
        ],
        [
            [
                frame,
                LABELS[chooser],
                *(
                    write(found[frame, IN_TABLE, chooser, predictor])
                    for predictor in PREDICTORS
                    for write in (_accuracy, _loss)
                ),
            ]
            for frame in DRAWN
            for chooser in CHOOSERS
        ],
    )


def _mean(row: Row) -> float:
    return float(row["comparison"]["difference"]["mean"])


def _accuracy(row: Row) -> str:
    found = row["accuracy"]["objects"]
    return f"{share(found['mean'])} ({100 * found['low']:.0f}–{100 * found['high']:.0f})"


def _loss(row: Row) -> str:
    found = row["loss"]["objects"]
    return f"{found['mean']:.2f} ({found['low']:.2f}–{found['high']:.2f})"


@style()
def draw(cells: Sequence[Row]) -> Figure:
    """Draw accuracy and loss against touches, one panel per frame: learned predictor solid, fixed descriptors dotted."""
    figure = Figure(layout="constrained")
    panels = figure.subplots(1, 2 * len(DRAWN))
    for part, measure in enumerate(SIGNS):
        own_panels = panels[part * len(DRAWN) :][: len(DRAWN)]
        for panel, (frame, words) in zip(own_panels, DRAWN.items(), strict=True):
            panel.set_title(words.removeprefix("the "), fontsize=9.5)
            panel.set_xlabel("touches")
            panel.set_xticks(SHOWN)
            for (place, name), predictor in product(enumerate(CHOOSERS), PREDICTORS):
                learns = predictor == "learned"
                colour, mark = look(place)
                found = [
                    row[measure]["objects"]
                    for row in cells
                    if (row["frame"], row["chooser"], row["predictor"]) == (frame, name, predictor)
                ]
                line, low, high = ([one[end] for one in found] for end in ("mean", "low", "high"))
                panel.plot(
                    SHOWN,
                    line,
                    "-" if learns else ":",
                    color=colour,
                    marker=mark if learns else None,
                    markersize=4,
                    linewidth=1.5 if learns else 1,
                    label=LABELS[name].strip("`") if learns else None,
                )
                if learns and name == "random":
                    panel.fill_between(SHOWN, low, high, color=colour, alpha=0.12, linewidth=0)
        first, *others = own_panels
        first.set_ylabel(HEADS[measure])
        for panel in others:
            panel.sharey(first)
            panel.tick_params(labelleft=False)
        first.autoscale()
        if measure == "accuracy":
            first.yaxis.set_major_formatter(whole_percent)
        else:
            for panel in own_panels:
                panel.axhline(1, color="black", linestyle="--", linewidth=1)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower left", ncols=3)
    return resized(figure, 288)


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(figures_of_study(KEPT, ("benchmark",))["benchmark"]["cells"]), PICTURE)
