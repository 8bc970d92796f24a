"""The conditions of study `learned`, the table that it keeps, and the page from this table."""

import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from studies.surfaces import RUN

from classifier_settings.half import choosing_objects
from learned.accuracies import arrange
from learned.study import FRAMES, LONG, PIPELINES, TOUCHES, conditions
from learned_turned import study as learned_turned
from visuohaptic.base.errors import ReportError
from visuohaptic.evaluation.intervals import compare_paired, holm
from visuohaptic.meshes.catalogue import TEST_CLASSES
from visuohaptic.recognition.parameters import IntervalParameters, LearnedParameters
from visuohaptic.report.leads import KNOWN
from visuohaptic.studies.figures import Cell

FOLDER = Path(__file__).parents[3] / "studies/learned"
TURNED = FOLDER.with_name("learned_turned")


def test_each_frame_is_measured_by_one_view_and_five_touches_also_by_all_views():
    planned = list(conditions(RUN))
    changes = {one.name: one.changes for one in planned}
    many = RUN.viewpoints.total
    assert set(changes) == {
        *(f"none {frame} {touches} 1" for frame in FRAMES for touches in (*TOUCHES, LONG)),
        *(f"none {frame} 5 {many}" for frame in FRAMES),
    }
    assert changes["none centre 5 1"]["recognition.frame"] == "centre"
    assert changes["none centre 1 1"]["recognition.touches"] == 1
    assert changes["none full 20 1"]["probing.when_exhausted"] == "begin_again"
    assert "probing.when_exhausted" not in changes["none full 5 1"]
    assert changes["none centre 5 1"] == changes[f"none centre 5 {many}"]
    assert {one.votes for one in planned if one.name.endswith(f" {many}")} == {many}
    assert {one.votes for one in planned if one.name.endswith(" 1")} == {None}
    assert {one["recognition.pipelines"] for one in changes.values()} == {PIPELINES}


def test_turned_objects_are_measured_by_what_their_turn_leaves_known():
    changes = {one.name: one.changes for one in learned_turned.conditions(RUN)}
    many = RUN.viewpoints.total
    assert set(changes) == {
        f"{pose} 5 {views}" for pose in ("vertical vertical", "any none") for views in (1, many)
    }
    assert changes["any none 5 1"]["meshes.turns"] == "any"
    assert changes["vertical vertical 5 1"]["recognition.frame"] == "vertical"


@pytest.mark.parametrize(("frame", "setting"), [("full", "passes"), ("none", "pair_passes")])
def test_the_defaults_are_what_the_rule_takes_of_the_kept_scores(frame, setting):
    kept = json.loads((FOLDER / "chosen.json").read_text())
    scored = {
        (int(name.split()[1]), weight): accuracy
        for name, accuracies in kept["accuracy"].items()
        if name.split()[0] == frame
        for weight, accuracy in zip(kept["weights"], accuracies, strict=True)
    }
    close = [one for one in scored if scored[one] >= max(scored.values()) - 0.003]
    fewest = min(passes for passes, _ in close)
    taken = max((one for one in close if one[0] == fewest), key=scored.get)
    defaults = LearnedParameters()
    assert taken == (getattr(defaults, setting), defaults.discriminant_weight)


def test_rows_name_their_condition_and_a_failed_condition_is_named():
    key = ("any none 5 16", "learned", "fixation", "touch_network")
    cell = Cell((("box", "a"), ("cup", "b")), np.array([0.5, 1.0]), np.ones(2))
    (first, _) = arrange({key: cell}).to_pylist()
    assert first == {
        "turns": "any", "frame": "none", "touches": 5, "views": 16, "pipeline": "learned",
        "strategy": "fixation", "object": "box/a", "accuracy": 0.5, "weight": 1.0,
    }  # fmt: skip
    failed = Cell((), np.empty(0), np.empty(0), error="no sequence")
    said = "Condition any none 5 16 could not be measured: no sequence"
    with pytest.raises(ReportError, match=said):
        arrange({key: failed})


def held_out(name, folder=FOLDER):
    rows = pd.read_parquet(folder / f"kept_{name}.parquet")
    return rows[~rows["object"].isin(choosing_objects())]


def test_the_page_has_the_accuracies_of_objects_that_chose_nothing():
    rows = pd.concat([held_out("benchmark"), held_out("benchmark", TURNED)])
    rows = rows[(rows["touches"] >= 5) & (rows["strategy"] == "fixation")]
    page = (FOLDER / "README.md").read_text()
    assert f"On {rows['object'].nunique()} objects that chose nothing" in page
    block = re.search(r"<!-- comparison -->\n(.*)<!-- /comparison -->", page, re.S)[1]
    lines = [[cell.strip() for cell in line.split("|")[1:-1]] for line in block.splitlines()[2:]]
    means = {
        key: 100 * np.average(own["accuracy"], weights=own["weight"])
        for key, own in rows.groupby(["turns", "frame", "touches", "views", "pipeline"])
    }
    poses = [("none", frame) for frame in ("full", "vertical", "centre", "none")]
    poses += [("vertical", "vertical"), ("any", "none")]
    assert [cells[0] for cells in lines] == [
        KNOWN[frame] + ", turned" * (turns != "none") for turns, frame in poses
    ]
    for pose, cells in zip(poses, lines, strict=True):
        for setting, shown, gain in zip(
            ((5, 1), (LONG, 1), (5, 16)), cells[1::2], cells[2::2], strict=True
        ):
            if pose[0] != "none" and setting == (LONG, 1):
                assert (shown, gain) == ("not measured", "")
                continue
            before, after = (means[*pose, *setting, name] for name in PIPELINES)
            assert shown == f"{before:.1f} % → {after:.1f} %"
            assert f"{after - before:+.1f} (".replace("-", "−") in gain


def test_the_answer_counts_the_differences_that_stand_after_correction():
    rows = held_out("benchmark")
    text = " ".join((FOLDER / "README.md").read_text().split())
    is_long = rows["touches"] == LONG
    one, many, long = (
        counted(rows[chosen])
        for chosen in ((rows["views"] == 1) & ~is_long, rows["views"] == 16, is_long)
    )
    said = re.search(
        rf"in (\d+) of (\d+) settings with 5 touches from one view, in (\d+) of (\d+) with {LONG} touches, in (\d+) of (\d+) "
        r"with one touch, and in (\d+) of (\d+) with 5 touches from each of 16 views\.",
        text,
    )
    counts = [int(number) for number in said.groups()]
    for (fewest, most, total), shown in zip(
        (one[5], long[LONG], one[1], many[5]),
        zip(counts[::2], counts[1::2], strict=True),
        strict=True,
    ):
        assert fewest <= shown[0] <= most
        assert shown[1] == total
    assert (
        f"its gain is {one['gains']} points with 5 touches, {long['gains']} with {LONG}, and {many['gains']} from 16"
        in text
    )


def test_the_answer_on_turned_objects_counts_after_one_correction_for_both_numbers_of_views():
    rows = held_out("benchmark", TURNED)
    text = " ".join((FOLDER / "README.md").read_text().split())
    said = re.search(r"in (\d+) of 6 settings from one view and in (\d+) of 6 from 16", text)
    for views, shown in zip((1, 16), said.groups(), strict=True):
        fewest, most, total = counted(rows, views)[5]
        assert fewest <= int(shown) <= most
        assert total == 6


def counted(rows, views=None):
    """Return by touches how many settings of a question show a lead after Holm's correction, and the range of gains.

    With `views` only settings with so many views are counted; the correction is for all settings.

    The page draws fewer sign changes. A corrected p value within two standard errors of these from the level can lie on
    either side, so the fewest and the most settings are returned, with the number of all.
    """
    wide = rows.pivot(
        index=["turns", "frame", "touches", "strategy", "views", "object"],
        columns="pipeline",
        values=["accuracy", "weight"],
    )
    terms = (wide["accuracy"]["learned"] - wide["accuracy"]["order_free"]) * wide["weight"][
        "learned"
    ]
    signs = np.random.default_rng(0).choice([-1.0, 1.0], size=(100_000, rows["object"].nunique()))
    p_values, gains = {}, {}
    for setting, own in terms.groupby(level=[0, 1, 2, 3, 4]):
        differences = own.dropna().to_numpy()
        weights = wide["weight"]["learned"][own.dropna().index].sum()
        flipped = np.abs(signs[:, : len(differences)] @ differences)
        p_values[setting] = np.mean(flipped >= abs(differences.sum()) - 1e-12)
        gains[setting] = 100 * differences.sum() / weights
    corrected, error, worst = {}, {}, 0.0
    for rank, setting in enumerate(sorted(p_values, key=p_values.get)):
        times = len(p_values) - rank
        worst = max(worst, times * p_values[setting])
        corrected[setting] = worst
        error[setting] = times * np.sqrt(p_values[setting] / IntervalParameters().permutations)
    shown = {}
    for touches in {one[2] for one in gains}:
        own = [one for one in gains if one[2] == touches and views in {None, one[4]}]
        ahead = (
            sum(gains[one] > 0 and corrected[one] + side * error[one] < 0.05 for one in own)
            for side in (2, -2)
        )
        shown[touches] = (*ahead, len(own))
    most = max(one[2] for one in gains)
    with_most = [gains[one] for one in gains if one[2] == most]
    ends = f"{min(with_most):+.1f} to {max(with_most):+.1f}".replace("-", "−")
    return {**shown, "gains": ends}


def test_the_page_says_how_often_sets_hold_the_class_of_objects_that_were_not_learnt():
    answers = pd.read_parquet(FOLDER.parent / "packaged_model/kept_all.parquet")
    known = answers[~answers["class"].isin(TEST_CLASSES)]
    text = " ".join((FOLDER / "README.md").read_text().split())
    for name, own in known.groupby("pipeline"):
        held = np.mean(
            [one in sets for one, sets in zip(own["class"], own["candidates"], strict=True)]
        )
        size = np.mean([len(sets) for sets in own["candidates"]])
        assert re.search(
            rf"{100 * held:.1f} % \([^)]*\) by `{name}`, with {size:.1f} classes", text
        )


def test_the_page_has_the_gains_on_set_all():
    rows = pd.read_parquet(FOLDER / "kept_all.parquet")
    benchmark = pd.read_parquet(FOLDER / "kept_benchmark.parquet")["object"]
    others = rows[~rows["object"].isin(benchmark)]
    text = " ".join((FOLDER / "README.md").read_text().split())
    total, shared = rows["object"].nunique(), rows["object"].nunique() - others["object"].nunique()
    chose = len({*rows["object"]} & choosing_objects())
    assert (
        f"Of all {total}, {shared} are in set `benchmark`, and {chose} chose the settings" in text
    )
    for part, start, middle in (
        (rows, "**On", ", by the places of touch, `learned` is shown to be ahead in"),
        (others, "On the", "`learned` is shown to be ahead in"),
    ):
        found, classes = counted(part), part["object"].str.split("/").str[0].nunique()
        sizes = part.groupby(["strategy"])["object"].nunique()
        said = re.search(
            rf"{re.escape(start)} {sizes.min()} to {sizes.max()} (?:objects|others,) of {classes} classes,? ?"
            rf"{re.escape(middle)} (\d+) of (\d+)",
            text,
        )
        fewest, most, settings = found[5]
        assert fewest <= int(said[1]) <= most
        assert int(said[2]) == settings
        wide = holm(
            [gain_of(own).p_value_new_classes for _, own in part.groupby(["frame", "strategy"])]
        )
        assert f"(for new classes in {sum(value < 0.05 for value in wide)} of {settings}" in text
        assert f"{found['gains']} points" in text


def gain_of(rows):
    """Compare the pipelines on the objects of one setting of set ``all``."""
    wide = rows.pivot(index="object", columns="pipeline", values="accuracy").sort_index()
    classes = [name.split("/")[0] for name in wide.index]
    before, after = (wide[name].to_numpy() for name in PIPELINES)
    return compare_paired(after, before, np.ones(len(wide)), IntervalParameters(), classes)


def test_the_page_has_the_accuracies_on_set_all_with_both_intervals():
    rows = pd.read_parquet(FOLDER / "kept_all.parquet")
    page = (FOLDER / "README.md").read_text()
    block = re.search(r"<!-- all_frames -->\n(.*)<!-- /all_frames -->", page, re.S)[1]
    for frame, line in zip(
        ("full", "vertical", "centre", "none"), block.splitlines()[2:], strict=True
    ):
        own = rows[(rows["frame"] == frame) & (rows["strategy"] == "fixation")]
        before, after = (
            100 * own[own["pipeline"] == name]["accuracy"].mean() for name in PIPELINES
        )
        found = gain_of(own)
        near, wide = (
            f"{100 * one.low:+.1f} to {100 * one.high:+.1f}"
            for one in (found.difference, found.difference_new_classes)
        )
        expected = f"| {KNOWN[frame]} | {before:.1f} % → {after:.1f} % | {after - before:+.1f} ({near}) | {wide} |"
        assert line == expected.replace("-", "−")


def test_the_page_counts_the_leads_of_fixation_by_the_network():
    rows = held_out("benchmark")
    rows = rows[(rows["views"] == 1) & (rows["touches"] != LONG) & (rows["pipeline"] == "learned")]
    wide = rows.pivot(
        index=["frame", "touches", "object"], columns="strategy", values=["accuracy", "weight"]
    )
    shown = []
    for _, own in wide.groupby(level=[0, 1]):
        for rival in ("random", "random_visible"):
            both = own[
                [("accuracy", "fixation"), ("accuracy", rival), ("weight", "fixation")]
            ].dropna()
            fixation, other, weights = both.to_numpy().T
            found = compare_paired(fixation, other, weights, IntervalParameters()).difference
            shown.append((found.low > 0) - (found.high < 0))
    text = " ".join((FOLDER / "README.md").read_text().split())
    said = "leads of fixation over random places in reach and in sight, with 1 and 5 touches"
    assert f"Of {len(shown)} {said}" in text
    assert f"above 0 in {shown.count(1)} and below 0 in {shown.count(-1)} (" in text


def test_the_page_counts_the_differences_on_the_objects_of_the_paper():
    rows = held_out("paper")
    text = " ".join((FOLDER / "README.md").read_text().split())
    is_long = rows["touches"] == LONG
    parts = ((rows["views"] == 1) & ~is_long, rows["views"] > 1, is_long)
    found = [counted(rows[part]) for part in parts]
    settings = [one[touches] for one in found for touches in one if touches != "gains"]
    total = sum(one[2] for one in settings)
    assert all(one[1] == 0 for one in settings)
    assert (
        f"On the paper's {rows['object'].nunique()} objects 0 of {total} differences are shown."
        in text
    )
