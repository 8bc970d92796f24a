"""Words and anchors."""

import pytest

from visuohaptic.fixations.probing import STRATEGIES
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
    assert percent(0.9345) == "93.5\xa0%"
    assert percent(0.9345, 2) == "93.45\xa0%"
    assert points(-0.036) == "−3.6"
    assert points(0.118) == "+11.8"
    assert probability(0.0410) == "0.041"
    assert probability(1e-6) == "< 0.0001"


@pytest.mark.parametrize(
    ("count", "noun", "text"),
    [
        (1, "class", "1 class"),
        (4, "class", "4 classes"),
        (5, "touch", "5 touches"),
        (1234, "job", "1,234 jobs"),
    ],
)
def test_nouns_are_counted(count, noun, text):
    assert counted(count, noun) == text


def test_lists_end_with_and():
    assert listed([]) == ""
    assert listed(["a"]) == "a"
    assert listed(["a", "b", "c"]) == "a, b and c"


def test_every_strategy_and_classifier_has_words_of_its_own():
    words = [strategy_name(name) for name in (*STRATEGIES.names, "adaptive")]
    words += [classifier_name(name) for name in CLASSIFIERS.names]
    assert len(set(words)) == len(words)
    assert not any("_" in text for text in words)


def test_names_begin_sentences():
    assert titled("naïve Bayes") == "Naïve Bayes"
    assert titled("k nearest neighbours") == "k nearest neighbours"


def test_anchors_are_safe_stable_and_different():
    keys = ["cup/mug", "cup/Mug", "cup/<mug>", "cup/../../x", "茶/碗", "cup/" + "x" * 300]
    anchors = [anchor_of(key) for key in keys]
    assert len(set(anchors)) == len(keys)
    assert all(anchor.isascii() and anchor.replace("-", "").isalnum() for anchor in anchors)
    assert max(map(len, anchors)) < 64
    assert anchor_of("cup/mug") == "object-cup-mug-" + anchor_of("cup/mug")[-8:]


@pytest.mark.parametrize(
    ("row", "column", "place"),
    [(0, 0, "upper left"), (5, 5, "centre"), (9, 0, "lower left"), (5, 9, "middle right")],
)
def test_places_in_a_view(row, column, place):
    assert place_in_view(row, column, 10, 10) == place
