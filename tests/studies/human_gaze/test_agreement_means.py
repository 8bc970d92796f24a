from dataclasses import replace

import numpy as np
import pytest
from studies.human_gaze.made_up import made_up_object

from human_gaze.agreement import human_weights, measure_all
from human_gaze.agreement_means import beside_peer, summarise
from human_gaze.gazed_objects import GazeSettings
from human_gaze.predicting import PREDICTORS

SETTINGS = GazeSettings(folds=2)


@pytest.fixture(scope="module")
def objects():
    training = [made_up_object(f"thing{chr(97 + n)}", "height", n) for n in range(6)]
    training[:4] = [replace(one, peer=one.gazed.density) for one in training[:4]]
    return [*training, made_up_object("new", "height", 9, is_test=True)]


@pytest.fixture(scope="module")
def table(objects):
    return measure_all(objects, SETTINGS)


def test_a_planted_term_is_ahead_of_equal_weights_in_both_parts(table):
    for part, count in (("training", 6), ("test", 1)):
        rows = {row.predictor.name: row for row in summarise(table, part)}
        assert list(rows) == [one.name for one in PREDICTORS if one.kind != "peer"]
        assert rows["human"].objects == count
        assert rows["place"].measures["correlation"].mean > 0.8
        assert rows["human"].gain.mean > 0.3
        assert rows["equal"].gain.mean == 0


def test_a_peer_is_compared_on_the_objects_that_it_predicted(table):
    rows = {row.predictor.name: row for row in beside_peer(table)}
    assert {row.objects for row in rows.values()} == {4}
    assert rows["peer"].measures["correlation"].mean == pytest.approx(1)
    assert rows["peer"].gain.mean == 0
    equal = rows["equal"]
    assert equal.gain.mean == pytest.approx(equal.measures["correlation"].mean - 1)


def test_means_are_those_of_the_rows_within_their_intervals_which_one_object_has_not(table):
    (human,) = (row for row in summarise(table, "test") if row.predictor.name == "human")
    assert np.isnan(human.gain.low)
    rows = [row for row in table.to_pylist() if row["part"] == "training"]
    for one in summarise(table, "training"):
        own = [row["similarity"] for row in rows if row["predictor"] == one.predictor.name]
        found = one.measures["similarity"]
        assert found.mean == pytest.approx(np.mean(own))
        assert found.low <= found.mean <= found.high


def test_weights_are_fitted_to_training_objects_alone(objects):
    changed = [*objects[:-1], made_up_object("new", "edge", 3, is_test=True)]
    first, second = human_weights(objects, SETTINGS), human_weights(changed, SETTINGS)
    assert first == second
    assert "new" not in first["objects"]
