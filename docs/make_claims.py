"""Fill the tables of the paper's claims from kept figures of study `claims`: `make readme`.

docs/figures/claims_paper.json and claims_benchmark.json are reports/studies/claims.json of the paper's
twelve objects and of the catalogue's 142.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

from kept_figures import SETS, kept_figures
from make_readings import points, share
from make_readme import fill_page

PAGE = Path(__file__).with_name("claims.md")
PIPELINES = ("paper", "best")
CLASSIFIER = "support_vector_machine"
STRATEGIES = {
    "fixation": "eye fixations",
    "random": "random, in reach",
    "random_visible": "random, among what the eye sees",
    "random_walk": "random walk over the surface",
    "random_anywhere": "random, also where no sensor can come",
}
CUES = {"as run": "skin and pose", "skin alone": "skin alone", "pose alone": "pose alone"}
OTHERS = (
    "without the map",
    "order shuffled",
    "sensor of fixed size",
    "wavelet, one scale",
    "wavelet, three scales",
)

Figures = Mapping[str, Any]
"""reports/studies/claims.json: by pipeline, strategy, classifier and condition."""


def strategy_table(figures: Figures) -> str:
    """Set each strategy's accuracy, and the lead of fixation over it, in both pipelines."""
    lines = [
        "| SVM, places of touch | paper's pipeline | fixation is ahead by | ours | fixation is ahead by |",
        "|---|---|---|---|---|",
    ]
    for strategy, words in STRATEGIES.items():
        cells = [figures[name][strategy][CLASSIFIER]["as run"] for name in PIPELINES]
        parts = [f"{accuracy(cell)} | {lead(cell)}" for cell in cells]
        lines.append(f"| {words} | {' | '.join(parts)} |")
    return "\n".join(lines)


def cue_table(sets: Mapping[str, Figures]) -> str:
    """Set strategy × cue × set: accuracy by fixation, and its lead over each kind of random touches."""
    opponents = [name for name in STRATEGIES if name != "fixation"]
    lines = [
        "| objects | pipeline | known of a touch | fixation | "
        + " | ".join(f"ahead of {STRATEGIES[name]}" for name in opponents)
        + " |",
        "|---|---|---|---|" + "---|" * len(opponents),
    ]
    for name, figures in sets.items():
        for pipeline in PIPELINES:
            for condition, words in CUES.items():
                of = {
                    strategy: figures[pipeline][strategy][CLASSIFIER][condition]
                    for strategy in STRATEGIES
                }
                leads = " | ".join(lead(of[strategy]) for strategy in opponents)
                lines.append(
                    f"| {SETS[name]} | {pipeline} | {words} | {accuracy(of['fixation'])} | {leads} |"
                )
    return "\n".join(lines)


def share_table(sets: Mapping[str, Figures]) -> str:
    """Set what reach, sight and saliency each add to the lead over random touches anywhere."""
    lines = [
        "| objects | pipeline | anywhere | and in reach | and in sight | and salient | whole lead |",
        "|---|---|---|---|---|---|---|",
    ]
    order = ("random_anywhere", "random", "random_visible", "fixation")
    for name, figures in sets.items():
        for pipeline in PIPELINES:
            reached = [figures[pipeline][one][CLASSIFIER]["as run"]["accuracy"] for one in order]
            steps = [points(after - before) for before, after in pairwise(reached)]
            lines.append(
                f"| {SETS[name]} | {pipeline} | {share(reached[0])} | {' | '.join(steps)} "
                f"| {points(reached[-1] - reached[0])} |"
            )
    return "\n".join(lines)


def change_table(sets: Mapping[str, Figures]) -> str:
    """Set what each other condition changes, by fixation, in pairs over objects."""
    lines = [
        "| condition | compared with | objects | paper's pipeline | ours |",
        "|---|---|---|---|---|",
    ]
    for condition in OTHERS:
        for name, figures in sets.items():
            cells = [figures[one]["fixation"][CLASSIFIER][condition] for one in PIPELINES]
            against = cells[0]["compared_with"] or "as run"
            lines.append(
                f"| {condition} | {against} | {SETS[name]} | {' | '.join(map(change, cells))} |"
            )
    return "\n".join(lines)


def accuracy(cell: Mapping[str, Any]) -> str:
    """Write an accuracy with its interval."""
    return f"{share(cell['accuracy'])} ({100 * cell['low']:.1f}–{100 * cell['high']:.1f})"


def lead(cell: Mapping[str, Any]) -> str:
    """Write the lead of fixation with its interval and p value; empty for fixation itself."""
    if cell["lead"] is None:
        return ""
    return (
        f"{points(cell['lead'])} ({points(cell['lead_low'])} to {points(cell['lead_high'])}), "
        f"p {cell['lead_p']:.2g}"
    )


def change(cell: Mapping[str, Any]) -> str:
    """Write a change with its interval and Holm's p value."""
    if cell["error"] is not None or cell["difference"] is None:
        return ""
    return (
        f"{points(cell['difference'])} ({points(cell['difference_low'])} to "
        f"{points(cell['difference_high'])}), p {cell['adjusted_p']:.2g}"
    )


def blocks() -> dict[str, str]:
    """Give the tables of the page, by the names of their blocks."""
    found = kept_figures("claims")
    return {
        "strategies": strategy_table(found["paper"]),
        "benchmark": strategy_table(found["benchmark"]),
        "cues": cue_table(found),
        "shares": share_table(found),
        "changes": change_table(found),
    }


if __name__ == "__main__":
    fill_page(PAGE, blocks())
