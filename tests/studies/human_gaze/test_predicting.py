import numpy as np
import pytest
from studies.human_gaze.made_up import made_up_object

from human_gaze.gazed_objects import FEATURES, GazeSettings
from human_gaze.predicting import (
    BY_NAME,
    PREDICTORS,
    Predictor,
    assign_folds,
    choose_features,
    fit_predictor,
    predict,
    weights_of,
)
from human_gaze.recordings import GazeError
from human_gaze.surface_measures import MEASURES
from visuohaptic.attention import CHANNELS

HUMAN = BY_NAME["human"]
SETTINGS = GazeSettings(folds=4)
PENALTY = SETTINGS.penalty


def objects(planted, count=12, **settings):
    names = [f"thing{chr(97 + place)}" for place in range(count)]
    return [made_up_object(name, planted, seed, **settings) for seed, name in enumerate(names)]


def scores(made, weights, measure):
    return [MEASURES[measure](predict(one, HUMAN, weights[one.name]), one.gazed) for one in made]


@pytest.mark.parametrize("planted", ["curvature", "symmetry", "height", "relief_fine"])
def test_a_planted_feature_is_found_on_objects_held_out(planted):
    made = objects(planted)
    weights = weights_of(made, HUMAN, SETTINGS)
    for one in made:
        assert max(weights[one.name], key=weights[one.name].get) == planted
    assert min(scores(made, weights, "correlation")) > 0.8
    assert min(scores(made, weights, "auc_top")) > 0.8


def test_a_planted_weight_is_found_again():
    weights = fit_predictor(objects("height", 20), ("height",), (), 0.0)
    assert weights["height"] == pytest.approx(10, rel=1e-4)


def test_a_feature_that_people_avoid_gets_a_weight_below_zero_and_a_channel_none():
    found = fit_predictor(objects("height", strength=-2.0), FEATURES, (), PENALTY)
    assert found["height"] < -1
    found = fit_predictor(objects("edge", strength=-2.0), FEATURES, (), PENALTY)
    assert found["edge"] == min(found[name] for name in CHANNELS) == 0


def test_shuffled_gaze_gives_chance():
    made = objects("curvature", 24, shuffled=True)
    # Where a point is seen from more views it has more of the prediction; gaze here does not.
    weights = weights_of(made, HUMAN, SETTINGS)
    by_chance = scores(made, weights, "auc_top")
    error = np.std(by_chance) / np.sqrt(len(by_chance))
    assert abs(np.mean(by_chance) - 0.5) < 3 * error


@pytest.mark.parametrize(("name", "folds"), [("human", 6), ("chosen", 3)])
def test_weights_do_not_depend_on_the_object_held_out(name, folds):
    made = objects("curvature", 6)
    other = [*made[:-1], made_up_object(made[-1].name, "height", 99)]
    first, second = (
        weights_of(some, BY_NAME[name], GazeSettings(folds=folds))[made[-1].name]
        for some in (made, other)
    )
    assert first == second
    assert (len(first) < len(FEATURES)) == (name == "chosen")


def test_what_people_look_at_is_chosen_and_little_else():
    kept = choose_features(objects("height"), FEATURES, 3, PENALTY)
    assert "height" in kept
    assert len(kept) < len(FEATURES) / 2
    # Of one family none can be held out.
    assert choose_features(objects("height", 1), FEATURES, 3, PENALTY) == FEATURES


@pytest.mark.parametrize(
    ("count", "tested", "sentence"),
    [(3, {"thinga"}, "thinga would be in training and test"), (0, (), "0 objects")],
)
def test_no_object_and_an_object_in_both_parts_are_refused(count, tested, sentence):
    with pytest.raises(GazeError, match=sentence):
        fit_predictor(objects("curvature", count), FEATURES, tested, PENALTY)


def test_poses_of_one_figure_share_a_fold():
    made = [made_up_object(name, "edge", 0) for name in ("michael3", "michael8", "cat", "7")]
    folds = assign_folds(made, 3)
    assert set(folds) == {"michael", "cat", "7"}


@pytest.mark.parametrize("predictor", PREDICTORS, ids=lambda one: one.name)
def test_every_prediction_is_finite_and_zero_where_no_view_sees(predictor: Predictor):
    (one,) = objects("edge", 1)
    weights = dict.fromkeys(predictor.features, 1.0)
    found = predict(one, predictor, weights)
    assert np.isfinite(found).all()
    assert (found >= 0).all()
    assert not found[~one.gazed.seen].any()


def test_a_sum_is_the_mean_over_views_of_shares_of_the_maximum():
    (one,) = objects("edge", 1)
    place = FEATURES.index("curvature")
    found = predict(one, BY_NAME["curvature"], {"curvature": 1.0})
    for point in (0, 17):
        shares = [
            plane[place].flat[cells[point]] / plane[place].max() * visible[point]
            for plane, cells, visible in zip(one.planes, one.cells, one.visible, strict=True)
        ]
        assert found[point] == pytest.approx(np.mean(shares), rel=1e-5)
