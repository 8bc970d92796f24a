"""The options of what the network trains on, the rule that takes one in, and the page from the kept scores."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from recognition.synthetic import features_table
from sklearn.model_selection import StratifiedGroupKFold

from classifier_settings.half import choosing_objects
from learned.changed import draw_lots
from learned.choose import FOLDS
from learned.curves import accuracies, training_objects
from learned.study import STRATEGIES
from learned.training import (
    FEWER_TOUCHES,
    OPTIONS,
    RING,
    TURNED,
    correct,
    mirrored,
    noisy,
    shortened,
    stretched,
    taken,
)
from visuohaptic.recognition.parameters import LearnedParameters, RecognitionParameters
from visuohaptic.recognition.sequences import gather_pipeline

FOLDER = Path(__file__).parents[3] / "studies/learned"
SEQUENCES = gather_pipeline(features_table(), RecognitionParameters(), "learned")
NAMES = list(SEQUENCES.feature_names)


def columns(sequences, *names):
    return sequences.features[..., [NAMES.index(name) for name in names]]


def test_a_mirrored_object_has_its_bands_at_the_mirrored_angles():
    # Bands cover half a turn from -45 degrees; a mirror takes an angle to minus the angle.
    angles = np.deg2rad(-45 + 11.25 * (np.arange(16) + 0.5))
    wave = replace(SEQUENCES, features=SEQUENCES.features.copy())
    bands = [NAMES.index(f"contourlet_{band:02d}") for band in range(1, 17)]
    wave.features[..., bands] = np.cos(2 * angles) + np.sin(2 * angles)
    expected = np.cos(2 * angles) - np.sin(2 * angles)
    np.testing.assert_allclose(mirrored(wave).features[0, 0, bands], expected, atol=1e-12)
    assert np.array_equal(columns(mirrored(wave), "x", "normal_x"), -columns(wave, "x", "normal_x"))
    assert np.array_equal(columns(mirrored(wave), "y", "normal_z"), columns(wave, "y", "normal_z"))
    assert np.array_equal(mirrored(mirrored(wave)).features, wave.features)


def test_a_stretched_object_keeps_its_normals_at_right_angles_to_its_surface():
    features = SEQUENCES.features.copy()
    point, normal = ([NAMES.index(f"{kind}{axis}") for axis in "xyz"] for kind in ("", "normal_"))
    ways = np.random.default_rng(0).normal(size=features[..., point].shape)
    along = np.cross(ways, features[..., normal])
    moved = features.copy()
    moved[..., point] += along
    first, second = (stretched(replace(SEQUENCES, features=one)) for one in (features, moved))
    step = (second.features - first.features)[..., point]
    normals = first.features[..., normal]
    np.testing.assert_allclose((step * normals).sum(axis=-1), 0, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=-1), 1)
    factors = columns(first, "x") / features[..., [NAMES.index("x")]]
    assert len(np.unique(factors.round(9))) == len(SEQUENCES.objects)


def test_copies_with_noise_and_with_a_touch_left_out_keep_the_rest():
    difference = noisy(SEQUENCES).features - SEQUENCES.features
    varied = SEQUENCES.features.std(axis=(0, 1)) > 0
    ratio = difference.std(axis=(0, 1))[varied] / SEQUENCES.features.std(axis=(0, 1))[varied]
    np.testing.assert_allclose(ratio, 0.1, rtol=0.2)
    short = shortened(SEQUENCES).features
    assert short.shape[1] == FEWER_TOUCHES
    for kept, whole in zip(short, SEQUENCES.features, strict=True):
        rows = {touch.tobytes() for touch in whole}
        assert {touch.tobytes() for touch in kept} < rows


@pytest.mark.parametrize("name", OPTIONS)
def test_touches_of_a_tested_object_change_no_other_answer_of_its_fold(name, monkeypatch):
    few = RecognitionParameters(learned=LearnedParameters(units=4, passes=3, pair_passes=3))
    monkeypatch.setattr("learned.training.RecognitionParameters", lambda frame: few)
    kinds = (*OPTIONS["strategies and draws, as many steps"].more, RING, TURNED)
    owners, labels = SEQUENCES.object_index, SEQUENCES.labels
    folds = StratifiedGroupKFold(FOLDS, shuffle=True, random_state=0)
    tested = next(test for _, test in folds.split(labels, labels, owners) if 0 in owners[test])
    changed = SEQUENCES.features.copy()
    changed[owners == 0] += 5.0
    other = replace(SEQUENCES, features=changed)
    first, second = (
        correct(dict.fromkeys(kinds, one), "fixation", OPTIONS[name], "full")
        for one in (SEQUENCES, other)
    )
    rest = tested[owners[tested] != 0]
    assert np.array_equal(first[:, rest], second[:, rest])
    assert not np.array_equal(first, second)


def scored(**changes):
    """Return scores of all options without gain, but for some, as gains by name."""
    cells = [f"{tested} {frame}" for frame in ("full", "none") for tested in ("fixation", "random")]
    base = {
        name: {"accuracy": dict.fromkeys(cells, 0.5), "gain": [0.0, -0.01, 0.01]}
        for name in OPTIONS
    }
    for name, gain in changes.items():
        base[name.replace("_", " ")] |= {"gain": [gain, gain - 0.005, gain + 0.005]}
    return base


def test_the_rule_takes_the_largest_gain_that_is_shown_or_fewer_steps_nearby():
    assert taken(scored()) == "own"
    assert taken(scored(strategies=0.004)) == "own"
    assert taken(scored(strategies=0.02, noisy_copies=0.03)) == "noisy copies"
    assert taken(scored(strategies=0.031, noisy_copies=0.03)) == "noisy copies"
    many = scored(strategies=0.031) | {}
    many["strategies, as many steps"]["gain"] = [0.029, 0.02, 0.04]
    assert taken(many) == "strategies, as many steps"
    losing = scored(noisy_copies=0.03)
    losing["noisy copies"]["accuracy"] = losing["noisy copies"]["accuracy"] | {"random full": 0.4}
    assert taken(losing) == "own"
    assert taken(scored(turned_objects=0.05, second_ring_of_views=0.05)) == "own"


def test_the_page_has_the_gains_of_the_kept_scores():
    found = json.loads((FOLDER / "training.json").read_text())
    page = " ".join((FOLDER / "tried.md").read_text().split())
    for name in OPTIONS.keys() - {"own"}:
        mean, low, high = (f"{100 * one:+.1f}".replace("-", "−") for one in found[name]["gain"])
        assert f"{mean} ({low} to {high})" in page
        assert f"| {name} | " in page
    name = taken(found)
    said = "no option is taken in." if name == "own" else f"{name} is taken in."
    assert f"By the rule {said}" in page


def test_the_page_counts_the_drawn_views_that_become_right_and_wrong():
    shown = json.loads((FOLDER / "changed.json").read_text())
    before, after = (
        [one["key"].startswith(f"{one[name]}/") for one in shown] for name in ("before", "after")
    )
    assert (len(shown), sum(after), sum(before)) == (10, 6, 4)
    assert len({one["key"] for one in shown} - choosing_objects()) == 10
    page = " ".join((FOLDER / "tried.md").read_text().split())
    assert "Six become right, and four wrong." in page


def test_the_lots_are_of_changed_views_of_objects_that_chose_nothing():
    chose = sorted(choosing_objects())[0]
    views = [(f"cup/c{number}", view) for number in range(20) for view in range(3)]
    before = dict.fromkeys([*views, (chose, 0)], "cup")
    after = {view: "bed" if view[1] else "cup" for view in before} | {(chose, 0): "bed"}
    shown = draw_lots(before, after)
    assert len({one.key for one in shown}) == 10
    assert {(one.before, one.after) for one in shown} == {("cup", "bed")}
    assert 0 not in {one.viewpoint for one in shown}
    assert chose not in {one.key for one in shown}


def test_fewer_training_objects_are_a_part_of_more_and_never_tested():
    train = np.flatnonzero(SEQUENCES.object_index > 1)
    few, more, whole = (training_objects(SEQUENCES, train, count) for count in (1, 2, None))
    assert {*few} < {*more} <= {*whole} == {*SEQUENCES.object_index[train]}
    assert [*np.bincount(SEQUENCES.class_of_object[few])] == [1] * len(SEQUENCES.classes)


def test_each_object_has_an_accuracy_by_the_asked_strategy():
    apart = features_table("fixation", separation=2.0)
    alike = features_table("random", separation=0.0, seed=1)
    both = pa.concat_tables([apart, alike])
    found = {name: dict(accuracies(both, name, "full", "order_free")) for name in STRATEGIES[:2]}
    assert {*found["fixation"]} == {*found["random"]}
    assert len(found["random"]) == 12
    assert np.mean([*found["fixation"].values()]) > 0.9
    assert np.mean([*found["random"].values()]) < 0.6


def test_the_page_has_the_accuracies_by_training_objects():
    curves = json.loads((FOLDER / "curves.json").read_text())
    page = (FOLDER / "tried.md").read_text()
    block = page.split("<!-- curves -->\n")[1].split("<!-- /curves -->")[0]
    shown = [float(number) for number in re.findall(r"([\d.]+) %", block)]
    means = {
        (one["frame"], one["training_objects"], one["pipeline"]): one["mean"] for one in curves
    }
    expected = [
        100 * means[frame, count, pipeline]
        for frame in ("full", "none")
        for count in ("2 objects", "4 objects", "8 objects", "all")
        for pipeline in ("order_free", "learned")
    ]
    assert {one["objects"] for one in curves} == {75}
    assert shown == pytest.approx(expected, abs=0.05 + 1e-9)
