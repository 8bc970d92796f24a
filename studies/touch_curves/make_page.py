"""Fill README.md and draw its picture from the kept figures of this study."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from filling import (
    Figures,
    figures_of_study,
    fill_from_figures,
    lead_in_both,
    legend_beside,
    measured,
    resized,
    share,
    table,
    wrapped,
)
from make_claims import of_classifier
from matplotlib.figure import Figure

from visuohaptic.evaluation.intervals import SIGNIFICANCE, holm
from visuohaptic.report.estimates import Estimate
from visuohaptic.report.figures import Series, draw_by_touches
from visuohaptic.report.wording import listed, strategy_name, strategy_place

HERE = Path(__file__).parent
PAGE = HERE / "README.md"
PICTURE = HERE / "curves.png"
SHOWN = {"order_free": (1, 16), "paper": (16,)}
"""Numbers of touches in the table by pipeline."""
DRAWN = (1, 2, 3, 5, 8, 16)
"""Numbers of touches in the picture."""


def curve_table(figures: Figures) -> str:
    """Write accuracy by touches and fixation's gain in area, the strategy with the largest area in our pipeline first."""
    ours = figures["needed"]["order_free"]
    adjusted = {pipeline: adjusted_gains(figures, pipeline) for pipeline in SHOWN}
    rows = []
    for strategy in sorted(ours, key=lambda name: -of_classifier(ours[name])["area"]):
        cells: list[object] = [f"`{strategy}`"]
        for pipeline, touches in SHOWN.items():
            points = of_classifier(figures["curves"][pipeline][strategy])["points"]
            needed = of_classifier(figures["needed"][pipeline][strategy])
            cells += [share(points[number - 1][0]) for number in touches]
            if pipeline == "order_free":
                cells.append("never" if needed["touches"] is None else needed["touches"])
            p_value = adjusted[pipeline].get(strategy)
            cells.append("" if p_value is None else lead_in_both(needed, "gain", p_value))
        rows.append(cells)
    heads = ["strategy", *(f"ours, {number}" for number in SHOWN["order_free"])]
    heads += ["90 %", "area"]
    heads += [*(f"paper's, {number}" for number in SHOWN["paper"]), "area"]
    return table(heads, rows)


def adjusted_gains(figures: Figures, pipeline: str) -> dict[str, float]:
    """Return the p value of fixation's gain over each strategy of a pipeline, with Holm's correction for all of them."""
    of_strategy = {
        name: of_classifier(cell)["p_value"] for name, cell in figures["needed"][pipeline].items()
    }
    tested = {name: p_value for name, p_value in of_strategy.items() if p_value is not None}
    return dict(zip(tested, holm([*tested.values()]), strict=True))


def parted(figures: Figures, pipeline: str) -> tuple[list[str], list[str]]:
    """List the strategies of a pipeline that are ahead of fixation, and those behind, after Holm's correction."""
    gains = {
        name: of_classifier(figures["needed"][pipeline][name])["gain"]
        for name, p_value in adjusted_gains(figures, pipeline).items()
        if p_value < SIGNIFICANCE
    }
    ahead = [f"`{name}`" for name, gain in gains.items() if gain < 0]
    return ahead, [f"`{name}`" for name, gain in gains.items() if gain > 0]


def answers(figures: Figures) -> str:
    """Return what the curves say: who is ahead of fixation and behind it, who is first, and who comes soonest to 90 %."""
    (ahead, behind), (ahead_there, behind_there) = (parted(figures, pipeline) for pipeline in SHOWN)
    ours = {name: of_classifier(cell) for name, cell in figures["needed"]["order_free"].items()}
    fewest = min(row["touches"] for row in ours.values() if row["touches"])
    soonest = [f"`{name}`" for name, row in ours.items() if row["touches"] == fewest]
    one = {
        name: of_classifier(cell)["points"][0][0]
        for name, cell in figures["curves"]["order_free"].items()
    }
    best = max(one, key=lambda name: one[name])
    highest = max(
        point[0]
        for cell in figures["curves"]["paper"].values()
        for point in of_classifier(cell)["points"]
    )
    first = (
        f"**In our pipeline {listed(ahead) or 'no strategy'} is shown to be ahead of fixation.** Behind it are "
        f"{listed(behind) or 'none'}. {listed(soonest)} reach 90 % with the fewest touches, {fewest}."
    )
    touch = f"**The first touch** is best by `{best}`: {share(one[best])} of the views are right ([leads](../first_touch/README.md))."
    papers = (
        f"**In the paper's pipeline** no strategy has more than {share(highest)}. Ahead of fixation is "
        f"{listed(ahead_there) or 'none'}; behind are {listed(behind_there) or 'none'}."
    )
    return "\n".join(wrapped(f"- {text}", "  ") for text in (first, touch, papers))


def few_sentence(figures: Figures) -> str:
    """Return how many strategies differ from fixation on few objects, over both pipelines."""
    found = [p for pipeline in SHOWN for p in adjusted_gains(figures, pipeline).values()]
    (objects,) = {
        of_classifier(cell)["objects"]
        for cells in figures["needed"].values()
        for cell in cells.values()
    }
    return wrapped(
        f"- On the paper's {objects} objects {sum(p < SIGNIFICANCE for p in found)} of {len(found)} areas differ from "
        "fixation's after the correction ([kept_paper.json](kept_paper.json)).",
        "  ",
    )


def draw(sets: Mapping[str, Figures]) -> Figure:
    """Draw accuracy against touches on the largest set in our pipeline, with the interval of fixation."""
    curves = sets["benchmark"]["curves"]["order_free"]
    series = []
    for strategy in sorted(curves, key=strategy_place):
        points = of_classifier(curves[strategy])["points"]
        estimates = [Estimate(*points[number - 1]) for number in DRAWN]
        if strategy != "fixation":
            estimates = [Estimate(one.mean) for one in estimates]
        series.append(Series(strategy_name(strategy), strategy_place(strategy), estimates))
    chart = draw_by_touches(DRAWN, series)
    chart.axes[0].set_ylim(0.5, 1)
    return resized(legend_beside(chart), 300)


def blocks(sets: Mapping[str, Figures]) -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    return {
        "answers": answers(sets["benchmark"]),
        "curves": curve_table(sets["benchmark"]),
        "measured": measured(HERE),
        "few": few_sentence(sets["paper"]),
    }


if __name__ == "__main__":
    fill_from_figures(figures_of_study(HERE), PAGE, blocks, PICTURE, draw)
