"""Fill the tables of README.md from the kept tables: `make readme` and `make first_touch`."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from filling import DOCS, fill_page, points, share, table

from first_touch.study import FRAMES, RULES, TOUCHES
from first_touch.summary import LABELS, Place, accuracies, lead, read_kept
from visuohaptic.attention.registry import CHANNELS
from visuohaptic.evaluation.intervals import PairedComparison, holm
from visuohaptic.recognition.parameters import IntervalParameters
from visuohaptic.report.estimates import estimate, with_interval
from visuohaptic.report.leads import KNOWN
from visuohaptic.report.wording import POSES, probability
from visuohaptic.studies.keeping import kept_files

PAGE = Path(__file__).parent / "README.md"
SETS = {"benchmark": TOUCHES, "paper": (1, 2)}
"""Sets of objects with tables on the page, and the numbers of touches in the table of leads."""
RIVALS = ("random_visible", *RULES)
"""Opponents of strategy `human`."""

INTERVALS = IntervalParameters()
LEVEL = 0.05
"""A lead is shown if its p value, corrected by Holm where several leads are compared, is below this level."""


def blocks(name: str, rows: pd.DataFrame) -> dict[str, str]:
    """Return the tables of a set of objects by name of the block."""
    return {
        f"sentence {name}": textwrap.fill(f"{sentence(rows)}.", 100, break_on_hyphens=False),
        f"accuracies {name}": accuracy_table(rows),
        f"leads {name}": lead_table(rows, SETS[name]),
        f"parts {name}": part_table(rows),
    }


def accuracy_table(rows: pd.DataFrame) -> str:
    """Return the accuracies on upright objects with a known pose by strategy, pipeline and number of touches."""
    settings = [Place(pipeline, touches) for pipeline in PIPELINES for touches in TOUCHES]
    heads = ["places of touch"]
    heads += [f"{PIPELINES[one.pipeline]}, {counted(one.touches)}" for one in settings]
    lines = [
        [
            label,
            *(
                share(accuracies(rows, strategy, one).mean) if measured(rows, strategy, one) else ""
                for one in settings
            ),
        ]
        for strategy, label in LABELS.items()
    ]
    return table(heads, lines)


def lead_table(rows: pd.DataFrame, numbers_of_touches: Sequence[int]) -> str:
    """Return the lead of strategy `human` over each rival by measured setting; p values are corrected for the whole table."""
    settings = [
        Place(pipeline, touches, turns, known)
        for turns, frames in FRAMES.items()
        for known in frames
        for pipeline in (PIPELINES if known == "full" else ("order_free",))
        for touches in numbers_of_touches
    ]
    settings = [one for one in settings if measured(rows, "human", one)]
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
    looks = [(label, strategy, "default") for strategy, label in LABELS.items()]
    looks += [(f"fixations by channel {name} only", "fixation", name) for name in CHANNELS]
    cells = [
        (label, strategy, Place(pipeline, looking=looking))
        for label, strategy, looking in looks
        for pipeline in PIPELINES
        if strategy not in {"random", "random_visible"}
    ]
    cells = [cell for cell in cells if measured(rows, *cell[1:])]
    written = in_words([_over_sight(rows, strategy, setting) for _, strategy, setting in cells])
    by_label: dict[str, list[str]] = {}
    for (label, *_), words in zip(cells, written, strict=True):
        by_label.setdefault(label, []).append(words)
    heads = [
        "places of the first touch",
        *(f"{words}: minus random in sight" for words in PIPELINES.values()),
    ]
    return table(heads, [[label, *words] for label, words in by_label.items()])


def sentence(rows: pd.DataFrame) -> str:
    """Return sentences on the first touch by predicted gaze, upright, the whole pose known, in our pipeline."""
    one, two = Place(touches=1), Place(touches=2)
    right = accuracies(rows, "human", one).mean
    gaze, later = (lead(rows, "human", "random_visible", place, INTERVALS) for place in (one, two))
    highest = lead(rows, "human", "highest", one, INTERVALS)
    channels = lead(rows, "gaze_channels", "random_visible", one, INTERVALS)
    answer = "Yes, on upright objects" if _sign(gaze) > 0 else "Not shown"
    beside = {1: "worse", 0: "as well, as far as is shown", -1: "better"}[_sign(highest)]
    saliency = "help" if _sign(channels) > 0 else "do not help"
    gone = "is no longer shown" if _sign(gaze) > 0 else "is not shown either"
    stands = "stands" if _sign(later) > 0 else gone
    return (
        f"{answer}. With one touch where people are predicted to look, {share(right)} of the views are right in our pipeline; "
        f"the lead over random places in sight is {_both(gaze)}. The highest visible place, a rule without a model, does "
        f"{beside} (lead over it {_both(highest)}), and the model's channels of saliency by themselves {saliency} "
        f"({_both(channels)}). With two touches the lead {stands} ({_both(later)}) ({gaze.objects} objects, measured on "
        f"{rows.attrs['date']})"
    )


def _sign(compared: PairedComparison) -> int:
    """Return 1 for a lead that is ahead, -1 for a lead that is behind, and 0 if the p value is no smaller than `LEVEL`."""
    return int(np.sign(compared.difference.mean)) if compared.p_value < LEVEL else 0


def _both(compared: PairedComparison) -> str:
    """Return a lead in points with its intervals for new objects and for new classes."""
    new, drawn = estimate(compared.difference), estimate(compared.difference_new_classes)
    classes = (
        f", new classes {points(drawn.low)} to {points(drawn.high)}"
        if drawn.low is not None and drawn.high is not None
        else ""
    )
    objects = (
        f" (new objects {points(new.low)} to {points(new.high)}{classes})"
        if new.low is not None and new.high is not None
        else ""
    )
    return f"{points(new.mean)} points{objects}"


def measured(rows: pd.DataFrame, strategy: str, place: Place) -> bool:
    """Return whether a strategy was measured in a setting."""
    try:
        accuracies(rows, strategy, place)
    except LookupError:
        return False
    return True


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
        written.append(f"**{words}**, p {probability(p)}" if p < LEVEL else words)
    return written


def counted(touches: int) -> str:
    """Return a number of touches in words."""
    return f"{touches} touch{'' if touches == 1 else 'es'}"


PIPELINES = {"order_free": "ours", "paper": "the paper's pipeline"}

if __name__ == "__main__":
    for name in kept_files(PAGE.parent):
        fill_page(PAGE, blocks(name, read_kept(name)))
    said = f"**Does a model of gaze help to choose the first touch?** {sentence(read_kept('benchmark'))}"
    link = " ([first_touch](../studies/first_touch/README.md))"
    text = textwrap.fill(f"{said}{link}.", 100, break_on_hyphens=False)
    fill_page(DOCS / "two_questions.md", {"first touch": text})
