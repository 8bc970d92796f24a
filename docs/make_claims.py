"""Fill the tables of the paper's claims, and draw what each change makes, from kept figures of study `claims`: `make readme`.

docs/figures/claims_paper.json and claims_benchmark.json are reports/studies/claims.json of the paper's
twelve objects and of the catalogue's 142: by pipeline, strategy, classifier and condition.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import pairwise

from filling import (
    DOCS,
    SETS,
    Figures,
    difference,
    fill_page,
    kept_figures,
    points,
    save_picture,
    share,
    table,
)
from matplotlib.figure import Figure

from visuohaptic.report import figures
from visuohaptic.report.drawing import style
from visuohaptic.report.estimates import Estimate, with_interval
from visuohaptic.report.wording import pipeline_name

PAGE = DOCS / "claims.md"
PICTURE = DOCS / "pictures" / "claims.png"
KEPT = DOCS / "figures" / "claims"
STEPS = ("random_anywhere", "random", "random_visible", "fixation")
OTHERS = (
    "without the map",
    "order shuffled",
    "sensor of fixed size",
    "wavelet, one scale",
    "wavelet, three scales",
)


def pipelines_of(names: Iterable[str]) -> list[str]:
    """Return the names of the pipelines that kept figures have, the paper's first and then ours."""
    return sorted(names, key=lambda name: name != "paper")


def of_classifier(measured: Figures) -> Figures:
    """Return the figures of the one classifier with which a study measures a pipeline."""
    (found,) = measured.values()
    return found


def leads_table(sets: Mapping[str, Figures]) -> str:
    """Set the lead of fixation over each kind of random touches by set and pipeline."""
    opponents = [name for name in STEPS if name != "fixation"]
    opponents.insert(2, "random_walk")
    words = ["anywhere", "in reach", "by a walk", "in sight"]
    rows = [
        [
            SETS[name],
            pipeline_name(pipeline),
            share(of_classifier(found[pipeline]["fixation"])["as run"]["accuracy"]),
            *(
                with_interval(lead_of(of_classifier(found[pipeline][one])["as run"]), points)
                for one in opponents
            ),
        ]
        for name, found in sets.items()
        for pipeline in pipelines_of(found)
    ]
    heads = ["objects", "pipeline", "fixation", *(f"minus random {one}" for one in words)]
    return table(heads, rows).replace("\N{NO-BREAK SPACE}", " ")


def lead_of(cell: Figures) -> Estimate:
    """Return the lead of fixation with its interval for new objects."""
    return Estimate(*(cell[name] for name in ("lead", "lead_low", "lead_high")))


def share_table(sets: Mapping[str, Figures]) -> str:
    """Set what reach, sight and saliency each add to the lead over random touches anywhere."""
    heads = ["objects", "pipeline", "anywhere", "and in reach", "and in sight", "and salient"]
    rows = []
    for name, found in sets.items():
        for pipeline in pipelines_of(found):
            conditions = (of_classifier(found[pipeline][one]) for one in STEPS)
            reached = [one["as run"]["accuracy"] for one in conditions]
            steps = (points(after - before) for before, after in pairwise(reached))
            whole = points(reached[-1] - reached[0])
            rows.append([SETS[name], pipeline_name(pipeline), share(reached[0]), *steps, whole])
    return table([*heads, "whole lead"], rows)


def change_table(sets: Mapping[str, Figures]) -> str:
    """Set what each other condition changes, by fixation, in pairs over objects."""
    rows = []
    for condition in OTHERS:
        for name, found in sets.items():
            cells = [
                of_classifier(found[one]["fixation"])[condition] for one in pipelines_of(found)
            ]
            against = cells[0]["compared_with"] or "as run"
            rows.append([condition, against, SETS[name], *map(change, cells)])
    return table(["condition", "compared with", "objects", "paper's pipeline", "ours"], rows)


def change(cell: Figures) -> str:
    """Write a change with its interval and Holm's p value."""
    return difference(cell, "difference", "difference_low", "difference_high", "adjusted_p")


@style()
def draw(found: Figures, conditions: Mapping[str, str]) -> Figure:
    """Draw what conditions change on one set of objects, a row per condition and a mark per pipeline.

    `conditions` has the words for each condition.
    """
    series = []
    for place, pipeline in enumerate(pipelines_of(found)):
        cells = [of_classifier(found[pipeline]["fixation"])[one] for one in conditions]
        changes = [
            Estimate(*(cell[name] for name in ("difference", "difference_low", "difference_high")))
            for cell in cells
        ]
        series.append(figures.Series(pipeline_name(pipeline), place, changes))
    chart = figures.draw_leads(list(conditions.values()), "condition", series)
    chart.axes[0].set_xlabel("change of accuracy, percentage points")
    return chart


def blocks(sets: Mapping[str, Figures]) -> dict[str, str]:
    """Return the tables of the page by name of the block."""
    return {
        "leads": leads_table(sets),
        "shares": share_table(sets),
        "changes": change_table(sets),
    }


if __name__ == "__main__":
    kept = kept_figures(KEPT)
    fill_page(PAGE, blocks(kept))
    save_picture(draw(kept["benchmark"], {one: one for one in OTHERS}), PICTURE, 150)
