"""Fill README.md and draw its picture from the kept figures of this study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice
from pathlib import Path

from filling import (
    Figures,
    figures_of_study,
    fill_from_figures,
    lead_in_both,
    measured,
    points,
    resized,
    share,
    table,
    wrapped,
)
from matplotlib.figure import Figure

from eye_and_touch.section import draw_times
from eye_and_touch.study import CHECKED, LOOK, PRODUCT, STOPPING, TOUCH
from visuohaptic.evaluation.intervals import SIGNIFICANCE, holm
from visuohaptic.report.drawing import COLOURS, style

HERE = Path(__file__).parent
PAGE = HERE / "README.md"
PICTURE = HERE / "eye_and_touch.png"
ANSWERS = {
    LOOK: "look",
    TOUCH: "touch",
    PRODUCT: "both",
    CHECKED: "both, checked",
}
GAINS = (TOUCH, CHECKED)
"""Answers of the table whose gain is shown: touch over the look, and both checked over the better sense."""
ONLY_TOUCH = "random_visible"
"""The strategy of touch only in the picture."""


def sight_table(figures: Figures) -> str:
    """Write the accuracy of each answer, and the gains of touch and of both senses, by sight."""
    heads = ["sight", *ANSWERS.values(), "touch minus look", "checked minus better"]
    gains = [row["gains"][answer] for row in figures["sights"] for answer in GAINS]
    written = iter(
        [
            lead_in_both(gain, "difference", p_value)
            for gain, p_value in zip(gains, adjusted(gains), strict=True)
        ]
    )
    rows = [
        [
            row["sight"],
            *(share(row["answers"][answer]["accuracy"]) for answer in ANSWERS),
            *islice(written, len(GAINS)),
        ]
        for row in figures["sights"]
    ]
    return table(heads, rows)


def adjusted(gains: Sequence[Figures]) -> list[float]:
    """Return the p values of gains with Holm's correction for all of them."""
    return holm([gain["p_value"] for gain in gains])


def rule_sentence(figures: Figures) -> str:
    """Write the gain of the stopping rule over fixed numbers of touches, over all strategies."""
    stopped = [row for row in figures["budgets"] if row["answer"] == STOPPING]
    corrected = adjusted([row["gain"] for row in stopped])
    parts = []
    for budget in figures["prices"]["budgets"]:
        rows = [
            (row, p_value)
            for row, p_value in zip(stopped, corrected, strict=True)
            if row["budget"] == budget
        ]
        gains = [row["gain"]["difference"] for row, _ in rows]
        shown = sum(p < SIGNIFICANCE and row["gain"]["difference"] > 0 for row, p in rows)
        longest = max(row["seconds"] for row, _ in rows)
        parts.append(
            f"{points(min(gains))} to {points(max(gains))} points at {budget:g} s (shown for {shown} of {len(rows)} "
            f"strategies; {longest:.1f} s at most)"
        )
    return (
        f"The stopping rule gains, over fixed numbers of touches that take as long: {'; '.join(parts)} "
        f"({figures['objects']} objects, shown after Holm's correction)."
    )


def look_sentence(figures: Figures) -> str:
    """Write what a look and one touch classify, and how many touches by fixation are ahead of the look."""
    look, touched = looked(figures), touch_accuracies(figures)
    one = [accuracies[1] for accuracies in touched.values()]
    ahead = min(count for count, value in touched["fixation"].items() if value > look)
    seconds = figures["prices"]["look_seconds"]
    return (
        f"One view classifies {share(look)} in {seconds:g} s, one touch {share(min(one))} to {share(max(one))}, by the "
        f"strategy. Where the eye fixates, touch is ahead of the view from {ahead} touches on."
    )


def touch_accuracies(figures: Figures) -> dict[str, dict[int, float]]:
    """Return the accuracy of touch only in clean sight by strategy and number of touches."""
    found: dict[str, dict[int, float]] = {}
    for row in figures["curves"]:
        if row["answer"] == TOUCH:
            found.setdefault(row["strategy"], {})[row["touches"]] = row["accuracy"]
    return found


@style()
def draw(sets: Mapping[str, Figures]) -> Figure:
    """Draw accuracy against the robot's time on the largest set: look and touch, and touch only."""
    figures = sets["benchmark"]
    chart = draw_times(figures["curves"])
    (axes,) = chart.axes
    only = sorted(
        (row["seconds"], row["accuracy"])
        for row in figures["curves"]
        if (row["answer"], row["strategy"]) == (TOUCH, ONLY_TOUCH)
    )
    axes.plot(*zip(*only, strict=True), color=COLOURS["ink"], linestyle="--", marker="x")
    words = "touch only,\nrandom, in sight"
    axes.annotate(words, only[0], (-6, 8), textcoords="offset points", ha="right")
    axes.annotate("a look", (0.5, looked(figures)), (2, 8), textcoords="offset points")
    ticks = (0.5, 1, 2, 5, 10, 20, 40)
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.set_xticks([], minor=True)
    return resized(chart, 300)


def looked(figures: Figures) -> float:
    """Return the accuracy of a look in clean sight."""
    return float(figures["sights"][0]["answers"][LOOK]["accuracy"])


def blocks(sets: Mapping[str, Figures]) -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    many = sets["benchmark"]
    return {
        "look": wrapped(look_sentence(many)),
        "sights": sight_table(many),
        "rule": wrapped(rule_sentence(many)),
        "measured": measured(HERE),
    }


if __name__ == "__main__":
    fill_from_figures(figures_of_study(HERE), PAGE, blocks, PICTURE, draw)
