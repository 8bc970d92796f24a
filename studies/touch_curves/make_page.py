"""Fill README.md and draw its picture from the kept figures of this study."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from filling import (
    Figures,
    difference,
    figures_of_study,
    fill_from_figures,
    legend_beside,
    measured,
    resized,
    share,
    table,
)
from make_claims import of_classifier
from matplotlib.figure import Figure

from visuohaptic.report.estimates import Figure as Estimate
from visuohaptic.report.figures import Series, draw_by_touches
from visuohaptic.report.wording import strategy_name, strategy_place

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
    rows = []
    for strategy in sorted(ours, key=lambda name: -of_classifier(ours[name])["area"]):
        cells: list[object] = [f"`{strategy}`"]
        for pipeline, touches in SHOWN.items():
            points = of_classifier(figures["curves"][pipeline][strategy])["points"]
            needed = of_classifier(figures["needed"][pipeline][strategy])
            cells += [share(points[number - 1][0]) for number in touches]
            if pipeline == "order_free":
                cells.append("never" if needed["touches"] is None else needed["touches"])
            cells.append(difference(needed, "gain", "gain_low", "gain_high"))
        rows.append(cells)
    heads = ["strategy", *(f"ours, {number}" for number in SHOWN["order_free"])]
    heads += ["90 %", "area"]
    heads += [*(f"paper's, {number}" for number in SHOWN["paper"]), "area"]
    return table(heads, rows)


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
    return resized(legend_beside(chart), 340)


def blocks(sets: Mapping[str, Figures]) -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    return {"curves": curve_table(sets["benchmark"]), "measured": measured(HERE)}


if __name__ == "__main__":
    fill_from_figures(figures_of_study(HERE), PAGE, blocks, PICTURE, draw)
