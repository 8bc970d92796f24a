"""Fill README.md and draw its picture from the kept tables: `make readme` and `make learned`."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from filling import fill_page, plain, resized, save_picture, share, table, wrapped
from matplotlib.figure import Figure

from classifier_settings.half import choosing_objects
from learned.study import FRAMES, PIPELINES, STRATEGIES, TOUCHES
from learned.training import OPTIONS, taken
from visuohaptic.evaluation.intervals import (
    PairedComparison,
    class_interval,
    compare_paired,
    holm,
    object_interval,
)
from visuohaptic.evaluation.leads import compare_accuracies
from visuohaptic.evaluation.means_over_draws import ObjectAccuracies
from visuohaptic.meshes.catalogue import TEST_CLASSES
from visuohaptic.recognition.parameters import Frame, IntervalParameters
from visuohaptic.report.estimates import estimate, lead, with_interval
from visuohaptic.report.figures import Series, draw_leads, of_new_classes
from visuohaptic.report.leads import KNOWN
from visuohaptic.report.wording import points, strategy_name, strategy_place
from visuohaptic.studies.keeping import kept_file, kept_files, read_source

FOLDER = Path(__file__).parent
PAGE = FOLDER / "README.md"
MODELS = FOLDER.parent / "packaged_model"
"""The study that keeps the answers of models of both pipelines."""
TRIED = FOLDER / "tried.md"
PICTURE = FOLDER / "learned.png"
INTERVALS = IntervalParameters()
LEVEL = 0.05
"""A difference is shown if its p value, with Holm's correction for all settings of the set, is below this level."""

TABLED: tuple[Frame, ...] = ("full", "none")
"""Frames of the table; the picture has all."""

Setting = tuple[Frame, int, str]
"""Known part of the frame, touches per sequence, and strategy."""


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    many, few = (Gains.of(held_out(name)) for name in ("benchmark", "paper"))
    sources = []
    for path in kept_files(FOLDER).values():
        source, objects = read_source(path), pd.read_parquet(path)["object"].nunique()
        sources.append(f"{objects} objects: {source.commit[:12]}, {source.date}")
    heads = ["known of the pose", "touches by", "`order_free`", "`learned`"]
    return {
        "sentence": wrapped(f"{many.sentence()} {few.others_sentence()}"),
        "comparison": table([*heads, "`learned` minus `order_free`"], many.lines()),
        "sure": wrapped(sure_sentence(pd.read_parquet(kept_file(MODELS, "all")))),
        "questions": wrapped(question_sentence(many.rows)),
        "sources": wrapped(f"Measured once and kept; {'; '.join(sources)}."),
    }


def tried_blocks() -> dict[str, str]:
    """Return the generated parts of the page on what was tried, by name of the block."""
    found = json.loads((FOLDER / "training.json").read_text(encoding="utf-8"))
    heads = [
        "trains beside the tested strategy's touches",
        "steps",
        "gain",
        "gain of the discriminant only",
    ]
    rows = [
        [
            name,
            f"{OPTIONS[name].steps:.2g} ×",
            *(spread(one[part]) for part in ("gain", "discriminant")),
        ]
        for name, one in found.items()
        if name != "own"
    ]
    return {"training": table(heads, rows), "taken": wrapped(taken_sentence(found))}


def spread(gain: Sequence[float]) -> str:
    """Write a mean and the ends of its interval, shares, as points."""
    mean, low, high = map(points, gain)
    return f"{mean} ({low} to {high})"


def taken_sentence(found: Mapping[str, Any]) -> str:
    """Return what the rule takes in."""
    name = taken(found)
    if name != "own":
        return f"**By the rule {name} is taken in.**"
    best = max(OPTIONS.keys() - {"own"}, key=lambda option: float(found[option]["gain"][0]))
    return (
        f"**By the rule no option is taken in.** The largest gain, {spread(found[best]['gain'])} by "
        f"*{best}*, is not shown."
    )


def held_out(name: str) -> pd.DataFrame:
    """Return the kept rows of objects that chose nothing."""
    rows = pd.read_parquet(kept_file(FOLDER, name))
    return rows[~rows["object"].isin(choosing_objects())]


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

    @property
    def objects(self) -> int:
        """The number of objects."""
        return int(self.rows["object"].nunique())

    def lines(self) -> list[list[object]]:
        """Return the accuracies of both pipelines and their difference by the most touches, one line per tabled setting."""
        lines: list[list[object]] = []
        for setting, compared in self.compared.items():
            frame, touches, strategy = setting
            if touches == max(TOUCHES) and frame in TABLED:
                shares = [
                    share(accuracies(self.rows, *setting, pipeline).mean) for pipeline in PIPELINES
                ]
                text = plain(with_interval(estimate(compared.difference), points))
                gain = f"**{text}**" if self.stands[setting] else text
                lines.append([KNOWN[frame], strategy_name(strategy), *shares, gain])
        return lines

    def sentence(self) -> str:
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
            f"**On {self.objects} objects that chose nothing, `learned` is shown to be ahead of `order_free` in {count} "
            f"settings with five touches, and in {single} of {len(long)} with one touch.** With five touches its gain "
            f"is {points(gains[0])} to {points(gains[-1])} points, by the known part of the pose and the places of touch."
        )

    def others_sentence(self) -> str:
        """Return the number of differences that stand, in any setting."""
        return f"On the paper's {self.objects} objects {sum(self.stands.values())} of {len(self.stands)} differences are shown."


def question_sentence(rows: pd.DataFrame) -> str:
    """Return how often fixation is ahead of random places in pipeline `learned`, by uncorrected intervals."""
    leads = []
    for frame, touches in product(FRAMES, TOUCHES):
        fixation, *rivals = (
            accuracies(rows, frame, touches, strategy, "learned") for strategy in STRATEGIES
        )
        leads += [compare(fixation, one).difference for one in rivals]
    ahead, behind = sum(one.low > 0 for one in leads), sum(one.high < 0 for one in leads)
    return (
        f"Of {len(leads)} leads of fixation over random places in reach and in sight, by this network, {ahead} have an "
        f"interval above 0 and {behind} below 0 (95 %, not corrected; one draw of random places; "
        f"{rows['object'].nunique()} objects)."
    )


def sure_sentence(answers: pd.DataFrame) -> str:
    """Return how often the prediction sets of both pipelines hold the class of objects that their models did not learn."""
    known = answers[~answers["class"].isin(TEST_CLASSES)]
    said = []
    for name in reversed(PIPELINES):
        own = known[known["pipeline"] == name]
        held = [one in sets for one, sets in zip(own["class"], own["candidates"], strict=True)]
        values, weights = np.array(held, np.float64), np.ones(len(own))
        over_objects = object_interval(values, weights, INTERVALS)
        over_classes = class_interval(values, weights, own["class"].tolist(), INTERVALS)
        ends = "; ".join(
            f"{100 * one.low:.1f} to {100 * one.high:.1f}" for one in (over_objects, over_classes)
        )
        size = own["candidates"].map(len).mean()
        said.append(f"{share(over_objects.mean)} ({ends}) by `{name}`, with {size:.1f} classes")
    right = known.assign(right=(known["named"] == known["class"]).astype(np.float64))
    named = [
        f"{gain_of_models(right, column)} from {words}"
        for column, words in (("right", "16 views together"), ("views", "one view"))
    ]
    return (
        f"**Set `all`:** models of both pipelines answered for {known['object'].nunique()} objects of "
        f"{known['class'].nunique()} classes that they did not learn ([packaged_model](../packaged_model/README.md); fixation, "
        f"vertical known). They name right: {'; '.join(named)}. Sets of 90 % hold the class of {', and of '.join(said)}. "
        f"In brackets: new objects; new classes."
    )


def gain_of_models(answers: pd.DataFrame, column: str) -> str:
    """Write the mean of a column of both pipelines, and their difference with its intervals for new objects and classes."""
    wide = answers.pivot(index=["class", "object"], columns="pipeline", values=column)
    before, after = (wide[name].to_numpy() for name in PIPELINES)
    classes = wide.index.get_level_values("class").tolist()
    compared = compare_paired(after, before, np.ones(len(wide)), INTERVALS, classes)
    intervals = compared.difference, compared.difference_new_classes
    ends = "; ".join(f"{points(one.low)} to {points(one.high)}" for one in intervals)
    return f"{share(before.mean())} → {share(after.mean())}, {points(compared.difference.mean)} ({ends})"


def draw(gains: Gains) -> Figure:
    """Draw `learned` minus `order_free` by the most touches, one row per known part of the pose."""
    frames, most = tuple(reversed(FRAMES)), max(TOUCHES)
    series = []
    for strategy in STRATEGIES:
        leads = [lead(gains.compared[frame, most, strategy]) for frame in frames]
        wider = [of_new_classes(one) for one in leads]
        series.append(Series(strategy_name(strategy), strategy_place(strategy), leads, None, wider))
    rows = [KNOWN[frame] for frame in frames]
    return resized(draw_leads(rows, "known part of the pose", series), 315)


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
    fill_page(TRIED, tried_blocks())
    save_picture(draw(Gains.of(held_out("benchmark"))), PICTURE)
