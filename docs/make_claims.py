"""Fill the tables of the paper's claims, and draw the lead of fixation, from kept figures of study `claims`: `make readme`.

docs/figures/claims_paper.json and claims_benchmark.json are reports/studies/claims.json of the paper's
twelve objects and of the catalogue's 142: by pipeline, strategy, classifier and condition.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import pairwise

from filling import (
    COLOURS,
    DOCS,
    SETS,
    Figures,
    accuracy,
    difference,
    fill_from_figures,
    kept_figures,
    points,
    share,
    table,
)
from matplotlib.figure import Figure

PAGE = DOCS / "claims.md"
PICTURE = DOCS / "pictures" / "lead.png"
KEPT = DOCS / "figures" / "claims"
OPPONENTS = {
    "random": "random, in reach",
    "random_visible": "random, among what the eye sees",
    "random_walk": "random walk over the surface",
    "random_anywhere": "random, also where no sensor can come",
}
STRATEGIES = {"fixation": "eye fixations", **OPPONENTS}
CUES = {"as run": "skin and pose", "skin alone": "skin alone", "pose alone": "pose alone"}
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


def of_classifier(figures: Figures) -> Figures:
    """Return the figures of the one classifier with which a study measures a pipeline."""
    (found,) = figures.values()
    return found


def strategy_table(figures: Figures) -> str:
    """Set each strategy's accuracy, and the lead of fixation over it, in both pipelines."""
    ahead = "fixation is ahead by"
    rows = []
    for strategy, words in STRATEGIES.items():
        cells = [of_classifier(figures[name][strategy])["as run"] for name in pipelines_of(figures)]
        texts = (text for cell in cells for text in (accuracy(cell), lead(cell)))
        rows.append([words, f"`{strategy}`", *texts])
    return table(["places of touch", "strategy", "paper's pipeline", ahead, "ours", ahead], rows)


def cue_table(sets: Mapping[str, Figures]) -> str:
    """Set strategy × cue × set: accuracy by fixation, and its lead over each kind of random touches."""
    rows = [
        [
            SETS[name],
            pipeline,
            words,
            accuracy(of_classifier(figures[pipeline]["fixation"])[cue]),
            *(lead(of_classifier(figures[pipeline][one])[cue]) for one in OPPONENTS),
        ]
        for name, figures in sets.items()
        for pipeline in pipelines_of(figures)
        for cue, words in CUES.items()
    ]
    ahead = (f"ahead of {words}" for words in OPPONENTS.values())
    return table(["objects", "pipeline", "known of a touch", "fixation", *ahead], rows)


def share_table(sets: Mapping[str, Figures]) -> str:
    """Set what reach, sight and saliency each add to the lead over random touches anywhere."""
    order = ("random_anywhere", "random", "random_visible", "fixation")
    heads = ["objects", "pipeline", "anywhere", "and in reach", "and in sight", "and salient"]
    rows = []
    for name, figures in sets.items():
        for pipeline in pipelines_of(figures):
            found = (of_classifier(figures[pipeline][one]) for one in order)
            reached = [conditions["as run"]["accuracy"] for conditions in found]
            steps = (points(after - before) for before, after in pairwise(reached))
            whole = points(reached[-1] - reached[0])
            rows.append([SETS[name], pipeline, share(reached[0]), *steps, whole])
    return table([*heads, "whole lead"], rows)


def change_table(sets: Mapping[str, Figures]) -> str:
    """Set what each other condition changes, by fixation, in pairs over objects."""
    rows = []
    for condition in OTHERS:
        for name, figures in sets.items():
            cells = [
                of_classifier(figures[one]["fixation"])[condition] for one in pipelines_of(figures)
            ]
            against = cells[0]["compared_with"] or "as run"
            rows.append([condition, against, SETS[name], *map(change, cells)])
    return table(["condition", "compared with", "objects", "paper's pipeline", "ours"], rows)


def lead(cell: Figures) -> str:
    """Write the lead of fixation with its interval and p value; empty for fixation itself."""
    return difference(cell, "lead", "lead_low", "lead_high", "lead_p")


def change(cell: Figures) -> str:
    """Write a change with its interval and Holm's p value."""
    return difference(cell, "difference", "difference_low", "difference_high", "adjusted_p")


def draw(sets: Mapping[str, Figures]) -> Figure:
    """Draw the lead of fixation with its interval: a panel a set and pipeline, a row a cue."""
    figure = Figure(figsize=(10, 6.4), layout="constrained")
    axes = figure.subplots(len(sets), 2, sharey=True)
    for row, (name, figures) in zip(axes, sets.items(), strict=True):
        for panel, pipeline in zip(row, pipelines_of(figures), strict=True):
            panel.set_title(f"{SETS[name]}, pipeline {pipeline}")
            panel.axvline(0, color="#555d66", linewidth=1)
            for place, strategy in enumerate(OPPONENTS):
                cells = [of_classifier(figures[pipeline][strategy])[cue] for cue in CUES]
                leads = [100 * cell["lead"] for cell in cells]
                ends = [
                    [abs(100 * cell[end] - one) for cell, one in zip(cells, leads, strict=True)]
                    for end in ("lead_low", "lead_high")
                ]
                rows = [number + 0.16 * (1.5 - place) for number in range(len(CUES))]
                style = {"color": COLOURS[place], "label": OPPONENTS[strategy]}
                panel.errorbar(leads, rows, xerr=ends, fmt="osDX"[place], **style)
    axes[0, 0].set_yticks(range(len(CUES)), CUES.values())
    for panel in axes[-1]:
        panel.set_xlabel("lead of fixation, percentage points")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


def blocks(found: Mapping[str, Figures]) -> dict[str, str]:
    """Give the tables of the page, by the names of their blocks."""
    return {
        "strategies": strategy_table(found["paper"]),
        "benchmark": strategy_table(found["benchmark"]),
        "cues": cue_table(found),
        "shares": share_table(found),
        "changes": change_table(found),
    }


if __name__ == "__main__":
    fill_from_figures(kept_figures(KEPT), PAGE, blocks, PICTURE, draw)
