"""Words and anchors."""

from visuohaptic.active.registry import STRATEGIES
from visuohaptic.recognition.classifiers import CLASSIFIERS
from visuohaptic.report.wording import (
    anchor_of,
    classifier_name,
    counted,
    listed,
    percent,
    place_in_view,
    points,
    probability,
    strategy_name,
    titled,
)


def test_numbers_in_words():
    assert percent(0.9345, 2) == "93.45\xa0%"
    assert points(-0.036) == "−3.6"
    assert points(0.118) == "+11.8"
    assert probability(0.0410) == "0.041"
    assert probability(1e-6) == "< 0.0001"


def test_nouns_are_counted_and_lists_end_with_and():
    counts = (1, "class"), (4, "class"), (5, "touch"), (1234, "job")
    said = ["1 class", "4 classes", "5 touches", "1,234 jobs"]
    assert [counted(*one) for one in counts] == said
    assert [listed(names) for names in ([], ["a"], ["a", "b", "c"])] == ["", "a", "a, b and c"]


def test_every_strategy_and_classifier_has_words_of_its_own():
    words = [strategy_name(name) for name in (*STRATEGIES.names, "adaptive")]
    words += [classifier_name(name) for name in CLASSIFIERS.names]
    assert len(set(words)) == len(words)
    assert not any("_" in text for text in words)
    assert [titled(name) for name in ("naïve Bayes", "k nearest")] == ["Naïve Bayes", "k nearest"]


def test_anchors_are_safe_stable_and_different():
    keys = ["cup/mug", "cup/Mug", "cup/<mug>", "cup/../../x", "茶/碗", "cup/" + "x" * 300]
    anchors = [anchor_of(key) for key in keys]
    assert len(set(anchors)) == len(keys)
    assert all(anchor.isascii() and anchor.replace("-", "").isalnum() for anchor in anchors)
    assert max(map(len, anchors)) < 64


def test_places_in_a_view():
    places = (0, 0), (5, 5), (9, 0), (5, 9)
    said = ["upper left", "centre", "lower left", "middle right"]
    assert [place_in_view(*place, 10, 10) for place in places] == said
