"""The scores of unknown objects, and the rule that takes one in."""

import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from packaged_model import strangeness
from packaged_model.strangeness import (
    TODAY,
    Touched,
    areas,
    areas_of_test_classes,
    choose,
    gain_in_area,
    score,
    unknown,
)
from visuohaptic.meshes.catalogue import TEST_CLASSES

VIEWS, OBJECTS = 4, 10


def touched(names, centres, spread=0.3):
    """Return views of `OBJECTS` objects of each class around the centre of the class."""
    generator = np.random.default_rng(0)
    classes = np.repeat(names, OBJECTS)
    middles = np.repeat(centres, OBJECTS, axis=0) + generator.normal(0, spread, (len(classes), 8))
    owners = np.repeat(np.arange(len(classes)), VIEWS)
    rows = middles[owners] + generator.normal(0, 0.1, (len(owners), 8))
    return Touched(rows, owners, classes)


@pytest.fixture(scope="module")
def known():
    return touched(["a", "b", "c", "d", "e"], 3 * np.eye(8)[:5])


def test_every_score_is_higher_between_and_far_from_the_known_classes(known):
    asked = touched(["a", "b", "far"], np.vstack([3 * np.eye(8)[:2], [-9.0] * 8]))
    objects = np.arange(len(known.classes))
    scores = score(known.of(objects[objects % 2 == 0]), asked)
    assert [*scores.index] == [*range(30)]
    is_far = asked.classes == "far"
    distances = [TODAY, "nearest class", "nearest object, discriminant's space"]
    for name in distances:
        assert scores[name][is_far].min() > scores[name][~is_far].max()
    assert np.isfinite(scores.to_numpy()).all()


def test_scores_of_an_object_do_not_depend_on_who_else_is_asked(known):
    objects = np.arange(len(known.classes))
    train, few, more = known.of(objects[::2]), known.of(objects[1:6:2]), known.of(objects[1::2])
    first, second = score(train, few), score(train, more)
    pd.testing.assert_frame_equal(first, second.loc[first.index])


def test_no_object_of_a_test_class_counts_in_the_choice(known, monkeypatch):
    monkeypatch.setattr(strangeness, "FOLDS", 2)
    names = [*np.unique(known.classes), TEST_CLASSES[0]]
    centres = np.vstack([3 * np.eye(8)[:5], [9.0] * 8])
    both = touched(names, centres)
    is_of_test = both.classes[both.owners] == names[-1]
    other = Touched(both.rows + is_of_test[:, None], both.owners, both.classes)
    pd.testing.assert_frame_equal(areas(both), areas(other))
    assert [*areas(both).index] == names[:-1]


def test_the_rule_takes_the_largest_mean_area():
    by_class = pd.DataFrame({TODAY: np.full(20, 0.6), "near": np.full(20, 0.7), "far": 0.8})
    by_class.loc[0, "near"] = 0.95
    assert choose(by_class) == "far"
    gain = gain_in_area("far", by_class)
    assert gain["difference"]["mean"] == pytest.approx(0.2)
    assert gain["p_value"] < 0.05


def test_areas_of_test_classes_are_1_far_from_every_known_class_and_small_on_a_known_class(
    known, monkeypatch
):
    monkeypatch.setattr(strangeness, "FOLDS", 2)
    names = [*np.unique(known.classes), *TEST_CLASSES[:2]]
    centres = np.vstack([3 * np.eye(8)[:5], [-9.0] * 8, 3 * np.eye(8)[0]])
    found = areas_of_test_classes(touched(names, centres))
    assert [*found.index] == sorted(TEST_CLASSES[:2])
    assert found.loc[TEST_CLASSES[0], TODAY] == 1
    # The second test class lies on a known class.
    assert found.loc[TEST_CLASSES[1], TODAY] < 0.7


def test_known_objects_are_called_unknown_once_and_strange_ones_by_each_model(known, monkeypatch):
    monkeypatch.setattr(strangeness, "FOLDS", 2)
    monkeypatch.setattr(strangeness, "INNER_FOLDS", 3)
    names = [*np.unique(known.classes), TEST_CLASSES[0]]
    found = unknown(touched(names, np.vstack([3 * np.eye(8)[:5], [-9.0] * 8])), [TODAY])
    assert found.groupby("strange").size().to_dict() == {False: 50, True: 20}
    assert found.loc[found["strange"], TODAY].all()
    assert found.loc[~found["strange"], TODAY].mean() < 0.3


def test_the_page_says_what_was_measured():
    page = " ".join(Path(strangeness.__file__).with_name("strangeness.md").read_text().split())
    found = json.loads(strangeness.CHOSEN.read_text())
    areas, best = found["areas"], found["best"]
    assert best == max(areas, key=areas.get)
    gain = found["gain"]
    assert found["taken"] == (gain["p_value"] < 0.05 and gain["difference"]["mean"] > 0)
    of_test, again = found["areas of test classes"], found["gain on test classes"]["difference"]
    assert again["mean"] == pytest.approx(of_test[best] - of_test[TODAY], abs=0.001)
    assert again["low"] < 0 < again["high"]
    assert "on the seven test classes its lead is not shown" in page
    assert (
        f"gain is {again['mean']:.3f} ({again['low']:.3f} to {again['high']:.3f})".replace("-", "−")
        in page
    )
    strange, known = found["test classes"], found["known classes"]
    assert (
        f"it calls {100 * strange[best]:.0f} % unknown, and today's score {100 * strange[TODAY]:.0f} %"
        in page
    )
    shares = " and ".join(f"{100 * known[name]:.0f} %" for name in (best, TODAY))
    assert f"of {known['objects']} held-out objects of known classes {shares}" in page
    for name, area in areas.items():
        assert re.search(
            rf"\| {re.escape(name)}( \(today's\))? \| {area:.3f} \| {of_test[name]:.3f} \|", page
        )
