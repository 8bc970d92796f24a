"""Known objects by both pipelines, and the sentence of the page on their gains."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.compute as pc
import pytest
from studies.known_objects.made_up import PLANNED, turned_touches

from known_objects import network
from known_objects.network import PIPELINES, TOUCHES, accuracies, count_shown, measure
from known_objects.new_touches import answer_new_touches
from known_objects.study import MOST_TOUCHES, STRATEGIES

FOLDER = Path(network.__file__).parent


@pytest.fixture(scope="module")
def turned():
    return turned_touches(objects=3, turns=3, separation=0.2, viewpoints=3)


@pytest.fixture(scope="module")
def tables(turned):
    return [one.features for one in turned]


@pytest.mark.parametrize("touches", [5, MOST_TOUCHES])
def test_the_discriminant_names_the_objects_that_the_study_names(turned, tables, touches):
    answers = answer_new_touches(turned, "fixation", PLANNED[0].parameters.seed)
    after = answers.filter(pc.equal(answers["touches"], touches)).to_pandas()
    expected = after.groupby(["class", "object"])["correct"].mean().to_numpy()
    assert 0 < expected.mean() < 1
    found = accuracies(tables, "fixation", touches, "order_free", PLANNED[0].parameters)
    np.testing.assert_allclose(found, expected)


def test_each_strategy_and_number_of_touches_has_a_gain(tables, monkeypatch):
    shares = {"order_free": [0.5, 0.6, 0.7], "learned": [0.6, 0.8, 1.0]}
    monkeypatch.setattr(network, "accuracies", lambda *given: np.array(shares[given[3]]))
    rows = [*measure(tables, PLANNED[0].parameters)]
    settings = [(one["strategy"], one["touches"]) for one in rows]
    assert settings == [(strategy, touches) for strategy in STRATEGIES for touches in TOUCHES]
    assert {round(one["difference"]["mean"], 9) for one in rows} == {0.2}
    assert (rows[0]["order_free"], rows[0]["learned"]) == pytest.approx((0.6, 0.8))


def test_gains_are_counted_after_one_correction_for_all_sets():
    better, worse = {"difference": {"mean": 0.1}}, {"difference": {"mean": -0.1}}
    measured = {
        "a": [{"p_value": 0.004, **better}, {"p_value": 0.02, **better}],
        "b": [{"p_value": 0.03, **better}],
    }
    assert count_shown(measured) == (3, 3)
    measured["b"] += [{"p_value": 0.5, **better}] * 8
    assert count_shown(measured) == (1, 11)
    measured["b"].append({"p_value": 0.0001, **worse})
    assert count_shown(measured) == (1, 12)


def test_the_page_has_the_kept_accuracies():
    measured = json.loads((FOLDER / "network.json").read_text())
    page = " ".join((FOLDER / "README.md").read_text().split())
    assert set(measured) == {"ycb", "paper"}
    shown, total = count_shown(measured)
    assert f"{shown} of {total} gains are shown" in page
    for name, rows in measured.items():
        kept = json.loads((FOLDER / f"kept_{name}.json").read_text())
        by_touches = {one["strategy"]: one["by_touches"] for one in kept["figures"]}
        for row in rows:
            study = by_touches[row["strategy"]][row["touches"] - 1]["accuracy"]
            assert row["order_free"] == pytest.approx(study, abs=0.005)
        frame = pd.DataFrame(rows).set_index(["strategy", "touches"])
        for touches in TOUCHES:
            row = frame.loc["fixation", touches]
            before, after = (100 * row[pipeline] for pipeline in PIPELINES)
            assert f"{before:.1f} % → {after:.1f} %" in page
