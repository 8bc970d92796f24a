"""Fill README.md and draw its picture from the kept tables: `make readme` and `make learned`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from filling import fill_page, plain, read_json, resized, save_picture, share, table, wrapped
from matplotlib.figure import Figure

from classifier_settings.half import choosing_objects
from learned.compared import (
    FOLDER,
    INTERVALS,
    ComparedSetting,
    Gains,
    accuracies_in,
    answers_of,
    compare,
    held_out,
    kept_of_all,
    objects_in_words,
)
from learned.curves import FRAMES as CURVE_FRAMES
from learned.study import FRAMES, LONG, PIPELINES, STRATEGIES, TOUCHES
from learned.training import OPTIONS, taken
from learned_turned import study as learned_turned
from visuohaptic.evaluation.intervals import (
    class_interval,
    object_interval,
)
from visuohaptic.geometry.turning import Turns
from visuohaptic.meshes.catalogue import TEST_CLASSES
from visuohaptic.recognition.parameters import Frame
from visuohaptic.report.estimates import estimate, lead, with_interval
from visuohaptic.report.figures import Series, draw_leads, of_new_classes
from visuohaptic.report.leads import KNOWN
from visuohaptic.report.wording import points, strategy_name, strategy_place
from visuohaptic.studies.keeping import kept_file, kept_files, read_source

PAGE = FOLDER / "README.md"
TURNED = FOLDER.parent / "learned_turned"
"""The study with the same pipelines on turned objects."""
MODELS = FOLDER.parent / "packaged_model"
"""The study that keeps the answers of models of both pipelines."""
TRIED = FOLDER / "tried.md"
PICTURE = FOLDER / "learned.png"

MOST = max(TOUCHES)
UPRIGHT: Mapping[tuple[Turns, Frame], str] = {
    ("none", frame): KNOWN[frame] for frame in FRAMES[::-1]
}
"""Upright objects by the known part of their frame, in words."""
TURNED_POSES = {pose: f"{KNOWN[pose[1]]}, turned" for pose in learned_turned.POSES}
"""Turned objects by the known part of their frame, in words."""


def blocks() -> dict[str, str]:
    """Return the generated parts of the page by name of the block."""
    single, long, together = answers_of(held_out(FOLDER, "benchmark"))
    few = answers_of(held_out(FOLDER, "paper"))
    turned = Gains.of(held_out(TURNED, "benchmark")).by_views()
    whole, others = map(Gains.of, kept_of_all())
    sources = []
    for path, words in (
        *((path, "") for path in kept_files(FOLDER).values()),
        (kept_file(TURNED, "benchmark"), " turned"),
    ):
        source, objects = read_source(path), pd.read_parquet(path)["object"].nunique()
        sources.append(f"{objects}{words} objects: {source.commit[:12]}, {source.date}")
    heads = ["known of the pose"]
    for words in (
        f"{MOST} touches",
        f"{LONG} touches",
        f"{MOST} in each of {together.views} views",
    ):
        heads += [words, "gain"]
    rows = [
        *lines((single, long, together), UPRIGHT),
        *lines((turned[0], None, turned[1]), TURNED_POSES),
    ]
    return {
        "sentence": wrapped(
            f"{sentence(single, long, together)} {turned_sentence(*turned)} {paper_sentence(*few)}"
        ),
        "comparison": table(heads, rows),
        "all": wrapped(all_sentence(whole, others)),
        "all_frames": table(
            ["known of the pose", f"{MOST} touches", "gain, new objects", "new classes"],
            all_lines(whole),
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


def lines(
    answers: Sequence[Gains | None], poses: Mapping[tuple[Turns, Frame], str]
) -> Iterator[list[object]]:
    """Yield a line per pose: accuracies and gain by fixation with the most touches of each answer."""
    for pose, words in poses.items():
        line: list[object] = [words]
        for gains in answers:
            line += ["not measured", ""] if gains is None else cells(gains, pose)
        yield line


def cells(gains: Gains, pose: tuple[Turns, Frame]) -> list[str]:
    """Return both accuracies by fixation with the most touches, and the gain in points; bold if it is shown."""
    setting = ComparedSetting(*pose, gains.most, gains.views, STRATEGIES[0])
    text = plain(with_interval(estimate(gains.compared[setting].difference), points))
    return [both_accuracies(gains, setting), f"**{text}**" if gains.stands[setting] else text]


def both_accuracies(gains: Gains, setting: ComparedSetting) -> str:
    """Write the accuracies of both pipelines in a setting."""
    return " → ".join(share(accuracies_in(gains.rows, setting, name).mean) for name in PIPELINES)


def all_lines(gains: Gains) -> Iterator[list[object]]:
    """Yield a line per known part of the pose: accuracies by fixation, and the gain for new objects and new classes."""
    for pose, words in UPRIGHT.items():
        setting = ComparedSetting(*pose, gains.most, gains.views, STRATEGIES[0])
        gain = lead(gains.compared[setting])
        wider = with_interval(of_new_classes(gain), points)
        yield [
            words,
            both_accuracies(gains, setting),
            with_interval(gain, points),
            wider[wider.index("(") + 1 : -1],
        ]


def count_in_words(shown: tuple[int, int]) -> str:
    """Write how many of all, such as ``3 of 12``."""
    return f"{shown[0]} of {shown[1]}"


def ends(gains: Gains) -> str:
    """Write the smallest and the largest gain by the most touches, in points."""
    return " to ".join(map(points, gains.range()))


def sentence(single: Gains, long: Gains, together: Gains) -> str:
    """Return the answer."""
    return (
        f"**On {single.objects} objects that chose nothing, `learned` is shown to be ahead of `order_free` in "
        f"{count_in_words(single.ahead(MOST))} settings with {MOST} touches from one view, in {count_in_words(long.ahead(LONG))} with {LONG} touches, "
        f"in {count_in_words(single.ahead(1))} with one touch, and in {count_in_words(together.ahead(MOST))} with {MOST} touches from each of "
        f"{together.views} views.** By the known part of the pose and the places of touch its gain is {ends(single)} points "
        f"with {MOST} touches, {ends(long)} with {LONG}, and {ends(together)} from {together.views} views."
    )


def turned_sentence(single: Gains, together: Gains) -> str:
    """Return the answer on turned objects."""
    return (
        f"On objects turned about the vertical (known), or in any way (nothing known), it is shown to be ahead in "
        f"{count_in_words(single.ahead(MOST))} settings from one view and in {count_in_words(together.ahead(MOST))} from {together.views}, with gains "
        f"of {ends(single)} and {ends(together)} points."
    )


def paper_sentence(*answers: Gains) -> str:
    """Return the number of differences that stand, in any setting."""
    stands = [gains.stands[setting] for gains in answers for setting in gains.compared]
    return f"On the paper's {answers[0].objects} objects {sum(stands)} of {len(stands)} differences are shown."


def all_sentence(whole: Gains, others: Gains) -> str:
    """Return in how many settings `learned` is shown to be ahead on set ``all``, and on its objects outside the benchmark."""
    chose = whole.rows.loc[whole.rows["object"].isin(choosing_objects()), "object"].nunique()
    return (
        f"**On {objects_in_words(whole.compared.values())} objects of {whole.classes} classes, by the places of touch, "
        f"`learned` is shown to be ahead in {count_in_words(whole.ahead(MOST))} settings with {MOST} touches from one view**, by "
        f"{ends(whole)} points (for new classes in {count_in_words(whole.ahead_for_new_classes(MOST))}; Holm's correction for "
        f"all settings). The objects are those of set `all` that the package's model learns, if a view has {MOST} touches by "
        f"these places. Of all {whole.objects}, {whole.objects - others.objects} are in set `benchmark`, and {chose} chose the "
        f"settings. On the {objects_in_words(others.compared.values())} others, of {others.classes} classes, `learned` is shown "
        f"to be ahead in {count_in_words(others.ahead(MOST))} (for new classes in "
        f"{count_in_words(others.ahead_for_new_classes(MOST))}), with gains of {ends(others)} points. No question was written "
        f"before these figures were computed. By fixation:"
    )


def question_sentence(gains: Gains) -> str:
    """Return how often fixation is ahead of random places in pipeline `learned`, by uncorrected intervals."""
    leads = []
    for setting in gains.compared:
        if setting.strategy == STRATEGIES[0]:
            fixation, *rivals = (
                accuracies_in(gains.rows, setting._replace(strategy=name), "learned")
                for name in STRATEGIES
            )
            leads += [compare(fixation, one).difference for one in rivals]
    ahead, behind = sum(one.low > 0 for one in leads), sum(one.high < 0 for one in leads)
    return (
        f"Of {len(leads)} leads of fixation over random places in reach and in sight, with {' and '.join(map(str, TOUCHES))} "
        f"touches from one view by this network, intervals are "
        f"above 0 in {ahead} and below 0 in {behind} (95 %, not corrected; one draw of random places; {gains.objects} objects). "
        f"Leads on set `all` are in [two_questions.md](../../docs/two_questions.md)."
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
    return (
        f"Prediction sets of 90 % from 16 views hold the class of {', and of '.join(said)}. These are "
        f"{known['object'].nunique()} objects of set `all` that the models did not learn, with the vertical known "
        f"([packaged_model](../packaged_model/README.md); in brackets: new objects; new classes)."
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


if __name__ == "__main__":
    fill_page(PAGE, blocks())
    fill_page(TRIED, tried_blocks())
    save_picture(draw(answers_of(held_out(FOLDER, "benchmark"))[0]), PICTURE)
