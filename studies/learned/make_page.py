"""Fill README.md and draw its picture from the kept tables: `make readme` and `make learned`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from filling import fill_page, plain, read_json, resized, save_picture, share, table, wrapped
from matplotlib.figure import Figure

from classifier_settings.half import choosing_objects
from learned import all_classes
from learned.curves import FRAMES as CURVE_FRAMES
from learned.study import FRAMES, LONG, PIPELINES, STRATEGIES, TOUCHES
from learned.training import OPTIONS, taken
from learned_turned import study as learned_turned
from visuohaptic.evaluation.by_object import ObjectAccuracies
from visuohaptic.evaluation.intervals import (
    SIGNIFICANCE,
    PairedComparison,
    class_interval,
    holm,
    object_interval,
)
from visuohaptic.evaluation.leads import compare_accuracies
from visuohaptic.geometry.turning import Turns
from visuohaptic.meshes.catalogue import TEST_CLASSES
from visuohaptic.recognition.parameters import Frame, IntervalParameters
from visuohaptic.report.estimates import Row, estimate, lead, measured, with_interval
from visuohaptic.report.figures import Series, draw_leads, of_new_classes
from visuohaptic.report.leads import KNOWN
from visuohaptic.report.wording import points, strategy_name, strategy_place
from visuohaptic.studies.keeping import kept_file, kept_files, read_source

FOLDER = Path(__file__).parent
PAGE = FOLDER / "README.md"
TURNED = FOLDER.parent / "learned_turned"
"""The study with the same pipelines on turned objects."""
MODELS = FOLDER.parent / "packaged_model"
"""The study that keeps the answers of models of both pipelines."""
TRIED = FOLDER / "tried.md"
PICTURE = FOLDER / "learned.png"
INTERVALS = IntervalParameters()

MOST = max(TOUCHES)
UPRIGHT: Mapping[tuple[Turns, Frame], str] = {
    ("none", frame): KNOWN[frame] for frame in FRAMES[::-1]
}
"""Upright objects by the known part of their frame, in words."""
TURNED_POSES = {pose: f"{KNOWN[pose[1]]}, turned" for pose in learned_turned.POSES}
"""Turned objects by the known part of their frame, in words."""


class ComparedSetting(NamedTuple):
    """What the pipelines are compared in; `views` are classified together."""

    turns: Turns
    frame: Frame
    touches: int
    views: int
    strategy: str


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    single, long, together = answers_of(held_out(FOLDER, "benchmark"))
    few = answers_of(held_out(FOLDER, "paper"))
    turned = Gains.of(held_out(TURNED, "benchmark")).by_views()
    wide = read_json(all_classes.MEASURED)
    sources = []
    for path, words in (
        *((path, "") for path in kept_files(FOLDER).values()),
        (kept_file(TURNED, "benchmark"), " turned"),
    ):
        source, objects = read_source(path), pd.read_parquet(path)["object"].nunique()
        sources.append(f"{objects}{words} objects: {source.commit[:12]}, {source.date}")
    heads = ["known of the pose"]
    for words in (f"{MOST} touches", f"{LONG} touches", f"{MOST}, {together.views} views"):
        heads += [words, "gain"]
    rows = [
        *lines((single, long, together), UPRIGHT),
        *lines((turned[0], None, turned[1]), TURNED_POSES),
    ]
    return {
        "sentence": wrapped(
            f"{sentence(single, long, together)} {turned_sentence(*turned)} {others_sentence(*few)}"
        ),
        "comparison": table(heads, rows),
        "all": wrapped(all_sentence(wide)),
        "all_frames": table(
            ["known of the pose", f"{MOST} touches", "gain, new objects", "new classes"],
            all_lines(wide),
        ),
        "sure": wrapped(sure_sentence(pd.read_parquet(kept_file(MODELS, "all")))),
        "questions": wrapped(question_sentence(single)),
        "sources": wrapped(f"Measured once and kept; {'; '.join(sources)}."),
    }


def tried_blocks() -> dict[str, str]:
    """Return the generated parts of the page on what was tried, by name of the block."""
    found = read_json(FOLDER / "training.json")
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
    curves = pd.read_json(FOLDER / "curves.json")
    return {
        "training": table(heads, rows),
        "taken": wrapped(taken_sentence(found)),
        "curves": table(
            ["known of the pose", *curves["training_objects"].unique()], curve_lines(curves)
        ),
    }


def curve_lines(curves: pd.DataFrame) -> Iterator[list[object]]:
    """Yield a line per known part of the pose: the accuracies of both pipelines, by number of training objects."""
    for frame in CURVE_FRAMES:
        by_count = curves[curves["frame"] == frame].groupby("training_objects", sort=False)
        means = (part.set_index("pipeline")["mean"] for _, part in by_count)
        yield [KNOWN[frame], *(" → ".join(share(one[name]) for name in PIPELINES) for one in means)]


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


def held_out(folder: Path, name: str) -> pd.DataFrame:
    """Return the kept rows of objects that chose nothing."""
    rows = pd.read_parquet(kept_file(folder, name))
    return rows[~rows["object"].isin(choosing_objects())]


@dataclass(frozen=True)
class Gains:
    """The comparison of `learned` with `order_free` in the settings of one question.

    Attributes
    ----------
    rows : pandas.DataFrame
        Kept rows of held-out objects.
    compared : dict of ComparedSetting to PairedComparison
        `learned` minus `order_free`.
    stands : dict of ComparedSetting to bool
        Whether the p value, with Holm's correction for all settings, is below `SIGNIFICANCE`.
    """

    rows: pd.DataFrame
    compared: dict[ComparedSetting, PairedComparison]
    stands: dict[ComparedSetting, bool]

    @classmethod
    def of(cls, rows: pd.DataFrame) -> Gains:
        """Compare the pipelines in pairs over objects."""
        found = dict.fromkeys(rows[[*ComparedSetting._fields]].itertuples(index=False, name=None))
        settings = [ComparedSetting(*one) for one in found]
        compared = {
            one: compare(*(accuracies(rows, one, name) for name in reversed(PIPELINES)))
            for one in settings
        }
        corrected = holm([one.p_value for one in compared.values()])
        stands = [value < SIGNIFICANCE for value in corrected]
        return cls(rows, compared, dict(zip(compared, stands, strict=True)))

    @property
    def objects(self) -> int:
        """The number of objects."""
        return int(self.rows["object"].nunique())

    @property
    def views(self) -> int:
        """The number of views that are classified together."""
        return int(self.rows["views"].max())

    def by_views(self) -> tuple[Gains, Gains]:
        """Divide the settings by one view and by all views together; the correction stays that for all settings."""
        single, together = (
            {key: one for key, one in self.compared.items() if (key.views == 1) == is_single}
            for is_single in (True, False)
        )
        return (
            Gains(self.rows[self.rows["views"] == 1], single, self.stands),
            Gains(self.rows[self.rows["views"] > 1], together, self.stands),
        )

    def ahead(self, touches: int) -> str:
        """Return in how many of the settings with so many touches `learned` is shown to be ahead, such as ``3 of 12``."""
        own = [one for one in self.compared if one.touches == touches]
        count = sum(self.stands[one] and self.compared[one].difference.mean > 0 for one in own)
        return f"{count} of {len(own)}"

    def range(self) -> str:
        """Return the smallest and the largest gain by the most touches, in points."""
        gains = [
            one.difference.mean for key, one in self.compared.items() if key.touches == self.most
        ]
        return f"{points(min(gains))} to {points(max(gains))}"

    @property
    def most(self) -> int:
        """The most touches per view."""
        return max(one.touches for one in self.compared)

    def cells(self, pose: tuple[Turns, Frame]) -> list[str]:
        """Return both accuracies by fixation with the most touches, and the gain in points; bold if it is shown."""
        setting = ComparedSetting(*pose, self.most, self.views, STRATEGIES[0])
        means = [accuracies(self.rows, setting, name).mean for name in PIPELINES]
        text = plain(with_interval(estimate(self.compared[setting].difference), points))
        return [" → ".join(map(share, means)), f"**{text}**" if self.stands[setting] else text]


def answers_of(rows: pd.DataFrame) -> tuple[Gains, Gains, Gains]:
    """Compare the pipelines by one view, by one view with `LONG` touches, and by all views of an object together.

    Each question has its own correction.
    """
    is_single, is_long = rows["views"] == 1, rows["touches"] == LONG
    single, long, together = (
        Gains.of(rows[part]) for part in (is_single & ~is_long, is_long, ~is_single)
    )
    return single, long, together


def lines(
    answers: Sequence[Gains | None], poses: Mapping[tuple[Turns, Frame], str]
) -> Iterator[list[object]]:
    """Yield a line per pose: accuracies and gain by fixation with the most touches of each answer."""
    for pose, words in poses.items():
        cells: list[object] = [words]
        for gains in answers:
            cells += ["", ""] if gains is None else gains.cells(pose)
        yield cells


def sentence(single: Gains, long: Gains, together: Gains) -> str:
    """Return the answer."""
    return (
        f"**On {single.objects} objects that chose nothing, `learned` is shown to be ahead of `order_free` in "
        f"{single.ahead(MOST)} settings with five touches from one view, in {long.ahead(LONG)} with twenty, in "
        f"{single.ahead(1)} with one touch, and in {together.ahead(MOST)} with five from {together.views} views together.** "
        f"By the known part of the pose and the places of touch its gain is {single.range()} points with five touches, "
        f"{long.range()} with twenty, and {together.range()} from {together.views} views."
    )


def turned_sentence(single: Gains, together: Gains) -> str:
    """Return the answer on turned objects."""
    return (
        f"On objects turned about the vertical (known), or in any way (nothing known), it is shown to be ahead in {single.ahead(MOST)} settings from one view and in "
        f"{together.ahead(MOST)} from {together.views}, with gains of {single.range()} and {together.range()} points."
    )


def others_sentence(*answers: Gains) -> str:
    """Return the number of differences that stand, in any setting."""
    stands = [stands for gains in answers for stands in gains.stands.values()]
    return f"On the paper's {answers[0].objects} objects {sum(stands)} of {len(stands)} differences are shown."


def question_sentence(gains: Gains) -> str:
    """Return how often fixation is ahead of random places in pipeline `learned`, by uncorrected intervals."""
    leads = []
    for setting in gains.compared:
        if setting.strategy == STRATEGIES[0]:
            fixation, *rivals = (
                accuracies(gains.rows, setting._replace(strategy=name), "learned")
                for name in STRATEGIES
            )
            leads += [compare(fixation, one).difference for one in rivals]
    ahead, behind = sum(one.low > 0 for one in leads), sum(one.high < 0 for one in leads)
    return (
        f"Of {len(leads)} leads of fixation over random places in reach and in sight, by this network, intervals are "
        f"above 0 in {ahead} and below 0 in {behind} (95 %, not corrected; one draw of random places; "
        f"{gains.objects} objects); leads on set `all` are in "
        f"[two_questions.md](../../docs/two_questions.md)."
    )


def all_sentence(found: Mapping[str, Sequence[Row]]) -> str:
    """Return in how many settings `learned` is shown to be ahead on set ``all``, and the range of its gains."""
    gains = found["gains"]
    means = [row["difference"]["mean"] for row in gains]
    shown, of_new_classes = (
        sum(
            value < SIGNIFICANCE and mean > 0
            for value, mean in zip(holm([row[name] for row in gains]), means, strict=True)
        )
        for name in ("p_value", "p_value_new_classes")
    )
    return (
        f"**On {max(row['objects'] for row in gains)} objects of {gains[0]['classes']} classes (set `all`) `learned` is shown "
        f"to be ahead in {shown} of {len(gains)} settings with five touches from one view**, by {points(min(means))} to "
        f"{points(max(means))} points (Holm's correction for all; for new classes in {of_new_classes}; "
        f"{len(choosing_objects())} of the objects chose the settings; no question was written before). By fixation:"
    )


def all_lines(found: Mapping[str, Sequence[Row]]) -> Iterator[list[object]]:
    """Yield a line per known part of the pose: accuracies by fixation on set ``all``, and the gain's two intervals."""
    for frame in reversed(FRAMES):
        by_pipeline = {
            row["pipeline"]: row["accuracy"]
            for row in found["accuracies"]
            if (row["frame"], row["strategy"]) == (frame, STRATEGIES[0])
        }
        gain = next(
            measured(row, "difference")
            for row in found["gains"]
            if (row["frame"], row["strategy"]) == (frame, STRATEGIES[0])
        )
        wider = with_interval(of_new_classes(gain), points)
        yield [
            KNOWN[frame],
            " → ".join(share(by_pipeline[name]) for name in PIPELINES),
            with_interval(gain, points),
            wider[wider.index("(") :],
        ]


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
    return (
        f"From 16 views, prediction sets of 90 % hold the class of {', and of '.join(said)} (set `all`, vertical known, "
        f"objects that the model did not learn; new objects, then new classes; "
        f"[packaged_model](../packaged_model/README.md))."
    )


def draw(gains: Gains) -> Figure:
    """Draw `learned` minus `order_free` by one view and the most touches, one row per known part of the pose."""
    frames = tuple(reversed(FRAMES))
    series = []
    for strategy in STRATEGIES:
        leads = [
            lead(gains.compared[ComparedSetting("none", one, MOST, 1, strategy)]) for one in frames
        ]
        wider = [of_new_classes(one) for one in leads]
        series.append(Series(strategy_name(strategy), strategy_place(strategy), leads, None, wider))
    rows = [KNOWN[frame] for frame in frames]
    return resized(draw_leads(rows, "known part of the pose", series), 315)


def accuracies(rows: pd.DataFrame, setting: ComparedSetting, pipeline: str) -> ObjectAccuracies:
    """Return the objects' accuracies in a setting."""
    wanted = {**setting._asdict(), "pipeline": pipeline}
    is_wanted = np.logical_and.reduce([rows[name] == value for name, value in wanted.items()])
    chosen = rows[is_wanted].sort_values("object")
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
    save_picture(draw(answers_of(held_out(FOLDER, "benchmark"))[0]), PICTURE)
