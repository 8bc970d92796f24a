import numpy as np
import pytest
from sklearn.metrics import roc_auc_score

from visuohaptic.attention import AttentionError, area_under_curve, normalised_scanpath_saliency

EVERYWHERE = np.ones((20, 20), dtype=bool)


def test_area_is_that_of_the_receiver_operating_characteristic():
    rng = np.random.default_rng(0)
    saliency = rng.integers(0, 9, size=(20, 20)).astype(np.float32)
    target, mask = rng.random((20, 20)) < 0.2, rng.random((20, 20)) < 0.7
    expected = roc_auc_score(target[mask], saliency[mask])
    assert area_under_curve(saliency, target, mask) == pytest.approx(expected, abs=1e-12)


def test_perfect_and_empty_maps():
    target = np.zeros((20, 20), dtype=bool)
    target[3:6, 4:8] = True
    assert area_under_curve(target.astype(np.float32), target, EVERYWHERE) == 1.0
    assert area_under_curve(np.zeros((20, 20), np.float32), target, EVERYWHERE) == 0.5
    share = target.mean()
    expected = (1 - share) / np.sqrt(share * (1 - share))
    score = normalised_scanpath_saliency(target.astype(np.float32), target, EVERYWHERE)
    assert score == pytest.approx(expected)
    assert normalised_scanpath_saliency(np.ones((20, 20), np.float32), target, EVERYWHERE) == 0.0


@pytest.mark.parametrize("measure", [area_under_curve, normalised_scanpath_saliency])
def test_target_must_be_a_part_of_the_object(measure):
    for target in (EVERYWHERE, ~EVERYWHERE):
        with pytest.raises(AttentionError, match="is needed"):
            measure(np.ones((20, 20), np.float32), target, EVERYWHERE)
