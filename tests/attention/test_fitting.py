import numpy as np
import pytest

from visuohaptic.attention import CHANNELS, AttentionError, Example, fit_weights

ROWS, COLUMNS = np.mgrid[:64, :64]


def map_around(places, width=2.5):
    plane = np.zeros((64, 64), dtype=np.float32)
    for row, column in places:
        plane += np.exp(-((ROWS - row) ** 2 + (COLUMNS - column) ** 2) / (2 * width**2))
    return plane


def example(rng, telling, name="cup/a"):
    places = rng.integers(8, 56, size=(4, 2))
    maps = {
        channel: map_around(places if channel in telling else rng.integers(8, 56, size=(4, 2)))
        for channel in CHANNELS
    }
    return Example(name, maps, np.ones((64, 64), dtype=bool), places)


@pytest.mark.parametrize("telling", [("curvature",), ("colour", "symmetry")])
def test_channels_that_predict_the_places_get_the_weights(telling):
    rng = np.random.default_rng(1)
    weights = fit_weights([example(rng, telling) for _ in range(12)], tested=["cup/b"])
    measured = sum(getattr(weights, name) for name in telling)
    assert measured > 0.8 * len(CHANNELS)
    assert sum(weights.model_dump().values()) == pytest.approx(len(CHANNELS))
    assert min(weights.model_dump().values()) >= 0.0


def test_channel_that_did_not_run_gets_no_weight():
    rng = np.random.default_rng(2)
    shown = example(rng, CHANNELS)
    del shown.conspicuity["colour"]
    assert fit_weights([shown], tested=[]).colour == 0.0


def test_tested_objects_and_no_example_are_refused():
    shown = example(np.random.default_rng(3), ("edge",))
    for examples, culprit in (([shown], "tested objects cup/a"), ([], "0 examples")):
        with pytest.raises(AttentionError, match=culprit):
            fit_weights(examples, tested=["cup/a"])
