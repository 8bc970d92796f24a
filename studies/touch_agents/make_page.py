"""Fill README.md and draw its picture from the kept figures: `make readme`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from filling import (
    figures_of_study,
    fill_page,
    measured,
    points,
    save_picture,
    share,
    table,
    wrapped,
)
from matplotlib.figure import Figure

from touch_agents.measure import CHOOSERS, FRAMES, MEASURES, PREDICTORS, TOUCHES
from visuohaptic.report.drawing import INCH, look, style
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
"""Touches of the tables."""
DRAWN = {"full": "the whole pose known", "none": "nothing known of the pose"}
LEVEL = 0.05
LEARNED_GAIN = "learned - order_free"
Row = Mapping[str, Any]


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    figures = figures_of_study(KEPT, SETS)
    tested = figures["benchmark"]["differences"]
    return {
        "answer": answer(tested),
        "twelve": wrapped(_count(figures["paper"]["differences"], SETS["paper"])),
        "figures": figures_table(figures["benchmark"]["cells"], (IN_TABLE,)),
        "measured": measured(KEPT, SETS),
    }


def answer(rows: Sequence[Row]) -> str:
    """Return which leads and which gains of the learned predictor are shown, of accuracy and of loss."""
    leads = [row for row in rows if row["predictor"] in PREDICTORS]
    gains = [row for row in rows if row["predictor"] == LEARNED_GAIN]
    return "\n".join(
        wrapped(f"- {line}", "  ")
        for line in (
            f"**Choosers.** {_shown(leads, 'leads over random places in reach')}",
            f"**Predictors.** {_shown(gains, 'differences of `learned` minus `order_free`')}",
        )
    )


def _shown(rows: Sequence[Row], words: str) -> str:
    parts = []
    for measure, sign in (("accuracy", 1), ("loss", -1)):
        own = [row for row in rows if row["measure"] == measure]
        shown = [row for row in own if row["corrected"] < LEVEL]
        better = [row for row in shown if sign * _mean(row) > 0]
        largest = max(own, key=lambda row: sign * _mean(row))
        where = f"{LABELS[largest['chooser']]}, frame `{largest['frame']}`"
        if largest["predictor"] in PREDICTORS:
            where += f", predicted by `{largest['predictor']}`"
        worse = len(shown) - len(better)
        parts.append(
            f"In {measure} {len(better)} of {len(own)} {words} are shown to be better, {worse} to be worse. "
            f"The best is {_difference(largest)}{' points' * (measure == 'accuracy')}: {where}."
        )
    return " ".join(parts)


def _count(rows: Sequence[Row], words: str) -> str:
    shown = sum(row["corrected"] < LEVEL for row in rows)
    least = min(row["comparison"]["p_value"] for row in rows)
    return f"On the {words} {shown} of {len(rows)} differences are shown; the smallest p value is {least:.2g} before the correction."


def figures_table(cells: Sequence[Row], counts: Sequence[int]) -> str:
    """Write accuracy and loss of each predictor by frame, number of touches and chooser."""
    found = {(row["frame"], row["touches"], row["chooser"], row["predictor"]): row for row in cells}
    heads = [f"`{name}`{value}" for name in PREDICTORS for value in ("", ", loss")]
    named = ["frame", *(["touches"] if len(counts) > 1 else []), "chooser"]
    return table(
        [*named, *heads],
        [
            [
                *(frame, count, LABELS[chooser])[:: 1 if len(counts) > 1 else 2],
                *(
                    write(found[frame, count, chooser, predictor])
                    for predictor in PREDICTORS
                    for write in (_accuracy, _loss)
                ),
            ]
            for frame in FRAMES
            for count in counts
            for chooser in CHOOSERS
        ],
    )


def differences_table(rows: Sequence[Row]) -> str:
    """Write the compared differences by frame and chooser: accuracy in points, then loss."""
    found = {(row["frame"], row["chooser"], row["predictor"], row["measure"]): row for row in rows}

    def cell(frame: str, chooser: str, predictor: str) -> str:
        both = [found.get((frame, chooser, predictor, measure)) for measure in MEASURES]
        return "; ".join(_marked(row) for row in both if row is not None)

    leads = [f"lead, `{name}`" for name in PREDICTORS]
    return table(
        ["frame", "chooser", *leads, "`learned` minus `order_free`"],
        [
            [
                frame,
                LABELS[chooser],
                *(cell(frame, chooser, name) for name in (*PREDICTORS, LEARNED_GAIN)),
            ]
            for frame in FRAMES
            for chooser in CHOOSERS
        ],
    )


def _mean(row: Row) -> float:
    return float(row["comparison"]["difference"]["mean"])


def _marked(row: Row) -> str:
    return f"**{_difference(row)}**" if row["corrected"] < LEVEL else _difference(row)


def _difference(row: Row) -> str:
    found = row["comparison"]["difference"]
    write = points if row["measure"] == "accuracy" else _signed
    return f"{write(found['mean'])} ({write(found['low'])} to {write(found['high'])})"


def _signed(value: float) -> str:
    return f"{value:+.2f}".replace("-", "\N{MINUS SIGN}")


def _accuracy(row: Row) -> str:
    intervals = [row["accuracy"][name] for name in ("objects", "classes")]
    ends = "; ".join(f"{100 * one['low']:.0f}–{100 * one['high']:.0f}" for one in intervals)
    return f"{share(intervals[0]['mean'])} ({ends})"


def _loss(row: Row) -> str:
    intervals = [row["loss"][name] for name in ("objects", "classes")]
    ends = "; ".join(f"{one['low']:.2f}–{one['high']:.2f}" for one in intervals)
    return f"{intervals[0]['mean']:.2f} ({ends})"


@style()
def draw(cells: Sequence[Row]) -> Figure:
    """Draw accuracy and loss against touches, one column per frame: learned predictor solid, fixed descriptors dotted."""
    figure = Figure(figsize=(500 / INCH, 460 / INCH), layout="constrained")
    axes = figure.subplots(2, len(DRAWN), sharex=True, sharey="row")
    for column, (frame, words) in enumerate(DRAWN.items()):
        axes[0, column].set_title(words, fontsize=9.5)
        axes[1, column].set_xlabel("touches")
        for place, name in enumerate(CHOOSERS):
            colour, mark = look(place)
            for predictor in PREDICTORS:
                learns = predictor == "learned"
                own = [
                    row
                    for row in cells
                    if (row["frame"], row["chooser"], row["predictor"]) == (frame, name, predictor)
                ]
                for panel, value in zip(axes[:, column], ("accuracy", "loss"), strict=True):
                    found = [row[value]["objects"] for row in own]
                    line, low, high = (
                        [one[end] for one in found] for end in ("mean", "low", "high")
                    )
                    panel.plot(
                        TOUCHES,
                        line,
                        "-" if learns else ":",
                        color=colour,
                        marker=mark if learns else None,
                        markersize=4,
                        linewidth=1.5 if learns else 1,
                        label=LABELS[name].strip("`") if learns else None,
                    )
                    if learns and name == "random":
                        panel.fill_between(
                            TOUCHES, low, high, color=colour, alpha=0.12, linewidth=0
                        )
        axes[1, column].set_xticks(TOUCHES)
        axes[1, column].axhline(1, color="black", linestyle="--", linewidth=1)
    axes[0, 0].set_ylabel("correctly classified")
    axes[0, 0].yaxis.set_major_formatter(whole_percent)
    axes[1, 0].set_ylabel("loss (dashed: a blind guess)")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower left", ncols=3)
    return figure


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    save_picture(draw(figures_of_study(KEPT, ("benchmark",))["benchmark"]["cells"]), PICTURE)
