"""Each measure against its definition, written out by hand or by another library."""

import numpy as np
import pytest
from scipy.stats import entropy
from sklearn.metrics import roc_auc_score

from human_gaze import surface_measures as measures
from human_gaze.recordings import GazeError
from human_gaze.surface_measures import MEASURES, GazedSurface


def drawn(seed, points=400, even=False):
    rng = np.random.default_rng(seed)
    area = np.ones(points) if even else rng.random(points) + 0.1
    seen = rng.random(points) < 0.8
    return GazedSurface(rng.random(points) ** 3, area, seen), rng.random(points)


@pytest.mark.parametrize("seed", range(4))
def test_correlation_is_pearsons_with_areas_for_weights(seed):
    gazed, predicted = drawn(seed)
    seen = gazed.seen
    spread = np.cov(gazed.density[seen], predicted[seen], aweights=gazed.area[seen])
    expected = spread[0, 1] / np.sqrt(spread[0, 0] * spread[1, 1])
    assert measures.correlation(predicted, gazed) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_area_under_curve_by_time_is_that_of_weighted_samples(seed):
    gazed, predicted = drawn(seed)
    predicted = np.round(predicted, 2)  # some are equal
    values = predicted[gazed.seen]
    labels = np.repeat([1, 0], len(values))
    weights = np.concatenate([gazed.shares(), gazed.weights()])
    expected = roc_auc_score(labels, np.tile(values, 2), sample_weight=weights)
    assert measures.area_under_curve_of_gaze(predicted, gazed) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_area_under_curve_of_the_top_is_that_of_the_most_looked_at_fifth(seed):
    gazed, predicted = drawn(seed, even=True)
    density = gazed.density[gazed.seen]
    top = np.zeros(len(density), dtype=bool)
    top[np.argsort(-density)[: int(0.2 * len(density))]] = True
    expected = roc_auc_score(top, predicted[gazed.seen])
    assert measures.area_under_curve_of_top(predicted, gazed) == pytest.approx(expected, abs=1e-12)


def test_normalised_saliency_is_the_mean_of_z_scores_where_people_looked():
    gazed = GazedSurface(np.array([0.0, 3.0, 1.0, 9.0]), np.ones(4), np.array([1, 1, 1, 0], bool))
    predicted = np.array([1.0, 4.0, 1.0, 100.0])
    scores = (predicted[:3] - 2.0) / predicted[:3].std()
    assert measures.normalised_saliency(predicted, gazed) == pytest.approx(
        (3 * scores[1] + scores[2]) / 4
    )


@pytest.mark.parametrize("seed", range(4))
def test_divergence_is_the_relative_entropy_of_shares_and_similarity_what_they_have_in_common(seed):
    gazed, predicted = drawn(seed)
    scaled = (predicted * gazed.area)[gazed.seen]
    time = (gazed.density * gazed.area)[gazed.seen]
    assert measures.divergence(predicted, gazed) == pytest.approx(entropy(time, scaled), abs=1e-9)
    distance = np.abs(scaled / scaled.sum() - time / time.sum()).sum()
    assert measures.similarity(predicted, gazed) == pytest.approx(1 - distance / 2, abs=1e-12)


def test_an_even_prediction_is_at_chance():
    gazed, _ = drawn(0)
    even = np.ones(400)
    assert measures.correlation(even, gazed) == 0
    assert measures.normalised_saliency(even, gazed) == 0
    assert measures.area_under_curve_of_top(even, gazed) == 0.5
    assert measures.area_under_curve_of_gaze(even, gazed) == 0.5


@pytest.mark.parametrize("name", MEASURES)
def test_a_point_cut_in_two_of_half_the_area_changes_nothing_and_points_left_out_are_refused(name):
    gazed, predicted = drawn(3)
    halves = GazedSurface(
        np.tile(gazed.density, 2), np.tile(gazed.area / 2, 2), np.tile(gazed.seen, 2)
    )
    expected = MEASURES[name](predicted, gazed)
    tolerance = 0.01 if name == "auc_top" else 1e-9  # the fifth may end within a pair
    assert MEASURES[name](np.tile(predicted, 2), halves) == pytest.approx(expected, abs=tolerance)
    with pytest.raises(GazeError, match="The prediction has shape"):
        MEASURES[name](predicted, halves)


@pytest.mark.parametrize(
    ("density", "area", "seen", "culprit"),
    [
        ([1.0, 2.0], [1.0], [True, True], "shapes"),
        ([1.0, -1.0], [1.0, 1.0], [True, True], "density"),
        ([1.0, 1.0], [1.0, np.nan], [True, True], "area"),
        ([0.0, 1.0], [1.0, 1.0], [True, False], "No seen point was looked at"),
    ],
)
def test_a_surface_that_can_not_be_measured_is_refused(density, area, seen, culprit):
    with pytest.raises(GazeError, match=culprit):
        GazedSurface(np.array(density), np.array(area), np.array(seen))
