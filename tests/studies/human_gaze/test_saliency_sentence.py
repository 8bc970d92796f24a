"""The sentence on people's gaze is that of the means of the table."""

import pandas as pd
import pyarrow as pa
import pytest

from human_gaze.saliency_sentence import gaze_sentence, relation
from human_gaze.section import KEPT, sentences
from visuohaptic.report.estimates import Estimate

ROWS = [
    {"object": one, "predictor": predictor, "part": part, "correlation": correlation}
    for predictor, equal in (("equal", 0.1), ("chosen", 0.5), ("facing", 0.9))
    for one, part, correlation in (
        ("cow", "training", equal),
        ("cup", "training", equal + 0.2),
        ("new", "test", 1.0),
    )
]


def test_means_are_those_of_the_objects_held_out():
    found = gaze_sentence(pa.Table.from_pylist(ROWS), "2026-01-02")
    assert "on 2 objects with recorded gaze (measured on 2026-01-02, not in this run)" in found
    # Two objects can't exclude a correlation of 0.
    assert "saliency is unrelated to people's gaze on 2 objects" in found
    assert "is 0.20 (" in found
    assert "fitted to other objects, saliency is unrelated to people's gaze: 0.60 (" in found


@pytest.mark.parametrize(
    ("mean", "low", "high", "words"),
    [
        (0.16, 0.12, 0.2, "weakly related"),
        (0.1, 0.05, 0.2, "weakly related"),
        (0.09, 0.05, 0.2, "unrelated"),
        (0.16, -0.01, 0.4, "unrelated"),
        (0.3, 0.2, 0.4, "moderately related"),
        (0.5, 0.4, 0.6, "strongly related"),
        (-0.4, -0.5, -0.2, "inversely related"),
    ],
)
def test_words_follow_from_the_correlation(mean, low, high, words):
    assert relation(Estimate(mean, low, high)) == words


def test_the_words_on_the_kept_table_are_those_of_its_means():
    rows = pd.read_parquet(KEPT)
    rows = rows[rows["part"] == "training"]
    means = rows.groupby("predictor")["correlation"].mean()
    assert 0.1 <= means["equal"] < 0.3
    assert means["chosen"] >= 0.5
    count = rows[rows["predictor"] == "equal"]["object"].nunique()
    (found,) = sentences(None)
    assert f"saliency is weakly related to people's gaze on {count} objects" in found
    assert f"looked at each place is {means['equal']:.2f} (" in found
    assert f"saliency is strongly related to people's gaze: {means['chosen']:.2f} (" in found
