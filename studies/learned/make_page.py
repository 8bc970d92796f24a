"""Fill the tables of README.md from the kept tables: `make readme` and `make learned`."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from filling import fill_page, table

from classifier_settings.half import choosing_objects
from learned.study import FRAMES, PIPELINES, STRATEGIES, TOUCHES
from visuohaptic.evaluation.intervals import PairedComparison, holm
from visuohaptic.evaluation.leads import compare_accuracies
from visuohaptic.evaluation.means_over_draws import ObjectAccuracies
from visuohaptic.recognition.parameters import Frame, IntervalParameters
from visuohaptic.report.estimates import both_intervals, lead
from visuohaptic.report.leads import KNOWN
from visuohaptic.report.wording import percent, points, strategy_name
from visuohaptic.studies.keeping import kept_files, read_source

FOLDER = Path(__file__).parent
PAGE = FOLDER / "README.md"
INTERVALS = IntervalParameters()
LEVEL = 0.05
"""A difference is shown if its p value, with Holm's correction for all settings of the set, is below this level."""

Setting = tuple[Frame, int, str]
"""Known part of the frame, touches per sequence, and strategy."""


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    heads = ["objects", "known of the pose", "touches", "touches by"]
    compared_lines, lead_lines, sources, sentence = [], [], [], ""
    for name, path in kept_files(FOLDER).items():
        source, rows = read_source(path), pd.read_parquet(path)
        held_out = rows[~rows["object"].isin(choosing_objects())]
        number = held_out["object"].nunique()
        gains = Gains.of(held_out)
        compared_lines += [[number, *line] for line in gains.lines()]
        lead_lines += [[number, *line] for line in question_lines(held_out)]
        sources.append(f"{number} objects: {source.commit[:12]}, {source.date}")
        sentence = gains.sentence(number) if name == "benchmark" else sentence
    gain = "`learned` minus `order_free`"
    questions = ["fixation minus random in reach", "fixation minus random in sight"]
    return {
        "sentence": textwrap.fill(sentence, 100, break_on_hyphens=False),
        "comparison": table([*heads, "`order_free`", "`learned`", gain], compared_lines),
        "questions": table([*heads[:3], *questions], lead_lines),
        "sources": textwrap.fill(
            f"Measured once and kept; {'; '.join(sources)}.", 100, break_on_hyphens=False
        ),
    }


@dataclass(frozen=True)
class Gains:
    """The comparison of `learned` with `order_free` in each setting of one set of objects.

    Attributes
    ----------
    rows : pandas.DataFrame
        Kept rows of held-out objects.
    compared : dict of (frame, touches, strategy) to PairedComparison
        `learned` minus `order_free`.
    stands : dict of (frame, touches, strategy) to bool
        Whether the p value, with Holm's correction for all settings, is below `LEVEL`.
    """

    rows: pd.DataFrame
    compared: dict[Setting, PairedComparison]
    stands: dict[Setting, bool]

    @classmethod
    def of(cls, rows: pd.DataFrame) -> Gains:
        """Compare the pipelines in pairs over objects."""
        settings = product(reversed(FRAMES), reversed(TOUCHES), STRATEGIES)
        compared = {
            one: compare(accuracies(rows, *one, "learned"), accuracies(rows, *one, "order_free"))
            for one in settings
        }
        corrected = holm([one.p_value for one in compared.values()])
        stands = [value < LEVEL for value in corrected]
        return cls(rows, compared, dict(zip(compared, stands, strict=True)))

    def lines(self) -> list[list[object]]:
        """Return the accuracies of both pipelines and their difference, one line per setting."""
        lines: list[list[object]] = []
        for setting, compared in self.compared.items():
            frame, touches, strategy = setting
            shares = [
                _plain(percent(accuracies(self.rows, *setting, pipeline).mean))
                for pipeline in PIPELINES
            ]
            text = in_words(compared)
            gain = f"**{text}**" if self.stands[setting] else text
            lines.append([KNOWN[frame], touches, strategy_name(strategy), *shares, gain])
        return lines

    def sentence(self, number: int) -> str:
        """Return the answer for the largest number of touches."""
        most = max(TOUCHES)
        long = {one: self.compared[one] for one in self.compared if one[1] == most}
        ahead = sum(self.stands[one] and long[one].difference.mean > 0 for one in long)
        gains = sorted(one.difference.mean for one in long.values())
        single = sum(
            self.stands[one] and compared.difference.mean > 0
            for one, compared in self.compared.items()
            if one[1] == 1
        )
        count = f"{ahead} of {len(long)}"
        return (
            f"**On {number} objects that chose nothing, `learned` is shown to be ahead of `order_free` in {count} "
            f"settings with five touches, and in {single} of {len(long)} with one touch.** With five touches its gain "
            f"is {points(gains[0])} to {points(gains[-1])} points, by the known part of the pose and the places of touch."
        )


def question_lines(rows: pd.DataFrame) -> list[list[object]]:
    """Return the leads of fixation over random places in pipeline `learned`, one line per frame and number of touches."""
    lines: list[list[object]] = []
    for frame, touches in product(reversed(FRAMES), reversed(TOUCHES)):
        fixation, *rivals = (
            accuracies(rows, frame, touches, strategy, "learned") for strategy in STRATEGIES
        )
        lines.append([KNOWN[frame], touches, *(in_words(compare(fixation, one)) for one in rivals)])
    return lines


def in_words(compared: PairedComparison) -> str:
    """Return a difference in points with both intervals."""
    figure = lead(compared)
    return _plain(f"{points(figure.mean)} {both_intervals(figure, points)}")


def _plain(text: str) -> str:
    return text.replace("\N{NO-BREAK SPACE}", " ")


def accuracies(
    rows: pd.DataFrame, frame: Frame, touches: int, strategy: str, pipeline: str
) -> ObjectAccuracies:
    """Return the objects' accuracies in a condition."""
    chosen = rows[
        (rows["frame"] == frame)
        & (rows["touches"] == touches)
        & (rows["strategy"] == strategy)
        & (rows["pipeline"] == pipeline)
    ].sort_values("object")
    keys = tuple((name.split("/")[0], name.split("/")[1]) for name in chosen["object"])
    return ObjectAccuracies(keys, *chosen[["accuracy", "weight"]].to_numpy(np.float64).T)


def compare(first: ObjectAccuracies, second: ObjectAccuracies) -> PairedComparison:
    """Compare two pipelines in pairs over objects: first minus second."""
    compared = compare_accuracies(first, second, INTERVALS)
    if compared is None:
        raise LookupError("The pipelines have no object in common.")
    return compared


if __name__ == "__main__":
    fill_page(PAGE, blocks())
