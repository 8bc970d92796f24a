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
from learned.study import FRAMES, LONG, PIPELINES, STRATEGIES, TOUCHES, conditions
from learned_turned import study as learned_turned
from visuohaptic.base.errors import ReportError
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
                assert shown == gain == ""
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
        r"in (\d+) of (\d+) settings with five touches from one view, in (\d+) of (\d+) with twenty, in (\d+) of (\d+) "
        r"with one touch, and in (\d+) of (\d+) with five from 16 views together\.",
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
        f"its gain is {one['gains']} points with five touches, {long['gains']} with twenty, and {many['gains']} from 16"
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


def test_the_page_has_the_gains_on_set_all_by_the_known_part_of_the_pose():
    found = json.loads((FOLDER / "all_classes.json").read_text())
    page = (FOLDER / "README.md").read_text()
    block = re.search(r"<!-- all_frames -->\n(.*)<!-- /all_frames -->", page, re.S)[1]
    shares = {
        (one["frame"], one["pipeline"]): 100 * one["accuracy"]
        for one in found["accuracies"]
        if one["strategy"] == "fixation"
    }
    by_fixation = {one["frame"]: one for one in found["gains"] if one["strategy"] == "fixation"}
    lines = block.splitlines()[2:]
    for frame, line in zip(("full", "vertical", "centre", "none"), lines, strict=True):
        before, after = (shares[frame, name] for name in PIPELINES)
        near, wide = (
            "{mean:+.1f} ({low:+.1f} to {high:+.1f})".format(
                **{end: 100 * value for end, value in by_fixation[frame][name].items()}
            ).replace("-", "−")
            for name in ("difference", "difference_new_classes")
        )
        said = f"{before:.1f} % → {after:.1f} % | {near} | {wide[wide.index('(') :]} |"
        assert line == f"| {KNOWN[frame]} | {said}"
    gains = [100 * one["difference"]["mean"] for one in found["gains"]]
    assert len(gains) == len(FRAMES) * len(STRATEGIES)
    # Every gain is above 0 and even the largest p value, times the number of gains, is small: Holm's correction drops none.
    for name in ("p_value", "p_value_new_classes"):
        assert len(gains) * max(one[name] for one in found["gains"]) < 0.05
    assert min(gains) > 0
    assert (
        f"ahead in {len(gains)} of {len(gains)} settings with five touches from one view**, by {min(gains):+.1f} to "
        f"{max(gains):+.1f} points (Holm's correction for all; for new classes in {len(gains)};"
        in " ".join(page.split())
    )
