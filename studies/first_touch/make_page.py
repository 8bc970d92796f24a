"""Fill the tables of README.md from the kept tables: `make readme` and `make first_touch`."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import pandas as pd
from filling import fill_page, points, share, table

from first_touch.keeping import KEPT
from first_touch.study import FRAMES, RULES, TOUCHES
from first_touch.summary import LABELS, Place, accuracies, lead, read_kept
from visuohaptic.attention.registry import CHANNELS
from visuohaptic.evaluation.intervals import PairedComparison, holm
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import estimate, with_interval
from visuohaptic.report.turned import KNOWN, POSES
from visuohaptic.report.wording import probability

PAGE = Path(__file__).parent / "README.md"
SETS = {"paper": "12 objects", "benchmark": "142 objects"}
RIVALS = ("random_visible", *RULES)
"""Opponents of strategy `human`."""

INTERVALS = IntervalParameters()


def blocks(name: str, rows: pd.DataFrame) -> dict[str, str]:
    """Return the tables of a set of objects by name of the block."""
    return {
        f"accuracies {name}": accuracy_table(rows),
        f"leads {name}": lead_table(rows),
        f"parts {name}": part_table(rows),
    }


def accuracy_table(rows: pd.DataFrame) -> str:
    """Return the accuracies on upright objects with a known pose by strategy, pipeline and number of touches."""
    settings = [Place(pipeline, touches) for pipeline in PIPELINES for touches in TOUCHES]
    heads = ["places of touch"]
    heads += [f"{PIPELINES[one.pipeline]}, {counted(one.touches)}" for one in settings]
    lines = [
        [label, *(share(accuracies(rows, strategy, one).mean) for one in settings)]
        for strategy, label in LABELS.items()
    ]
    return table(heads, lines)


def lead_table(rows: pd.DataFrame) -> str:
    """Return the lead of strategy `human` over each rival by setting; p values are corrected for the whole table."""
    settings = [
        Place(pipeline, touches, turns, known)
        for turns, frames in FRAMES.items()
        for known in frames
        for pipeline in (PIPELINES if known == "full" else ("order_free",))
        for touches in TOUCHES
    ]
    cells = list(product(settings, RIVALS))
    found = [lead(rows, "human", rival, setting, INTERVALS) for setting, rival in cells]
    written = dict(zip(cells, in_words(found), strict=True))
    heads = ["pipeline", "objects are", "known of the pose", "touches"]
    heads += [f"human minus {LABELS[rival]}" for rival in RIVALS]
    return table(
        heads,
        [
            [
                PIPELINES[one.pipeline],
                POSES[one.turns],
                KNOWN[one.known],
                one.touches,
                *(written[one, rival] for rival in RIVALS),
            ]
            for one in settings
        ],
    )


def part_table(rows: pd.DataFrame) -> str:
    """Return the lead over random places in sight at the first touch, of each strategy and of each single channel."""
    cells = [
        (label, strategy, Place(pipeline))
        for strategy, label in LABELS.items()
        for pipeline in PIPELINES
        if strategy not in {"random", "random_visible"}
    ]
    cells += [
        (f"fixations by channel {channel} only", "fixation", Place(pipeline, looking=channel))
        for channel in CHANNELS
        for pipeline in PIPELINES
    ]
    found = [_over_sight(rows, strategy, setting) for _, strategy, setting in cells]
    written = in_words(found)
    by_label: dict[str, list[str]] = {}
    for (label, *_), words in zip(cells, written, strict=True):
        by_label.setdefault(label, []).append(words)
    heads = [
        "places of the first touch",
        *(f"{words}: minus random in sight" for words in PIPELINES.values()),
    ]
    return table(heads, [[label, *words] for label, words in by_label.items()])


def _over_sight(rows: pd.DataFrame, strategy: str, setting: Place) -> PairedComparison:
    sight = rows[rows["strategy"] == "random_visible"].assign(looking=setting.looking)
    return lead(
        pd.concat([rows[rows["strategy"] == strategy], sight]),
        strategy,
        "random_visible",
        setting,
        INTERVALS,
    )


def in_words(found: list[PairedComparison]) -> list[str]:
    """Return leads with their intervals, in bold if the p value after Holm's correction for all of them is below 0.05."""
    written = []
    for one, p in zip(found, holm([one.p_value for one in found]), strict=True):
        words = with_interval(estimate(one.difference), points)
        written.append(f"**{words}**, p {probability(p)}" if p < 0.05 else words)
    return written


def counted(touches: int) -> str:
    """Return a number of touches in words."""
    return f"{touches} touch{'' if touches == 1 else 'es'}"


PIPELINES = {"order_free": "ours", "paper": "the paper's pipeline"}

if __name__ == "__main__":
    for name in SETS:
        if PAGE.with_name(KEPT.format(name)).exists():
            fill_page(PAGE, blocks(name, read_kept(name)))
