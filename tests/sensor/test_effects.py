"""What holds of every effect of the sensor, by its entry alone."""

import numpy as np
import pytest
from sensor.scenes import with_modes

from visuohaptic.scene.parameters import TACTILE_EFFECTS, Scene
from visuohaptic.sensor import EFFECTS, RandomFields, TouchBatch, simulate

TOUCHES = 3
CONTACT = np.random.default_rng(0).random((TOUCHES, 4, 4))
CONTACT[0] = 0.0
GAPS = 5e-4 * np.random.default_rng(1).random((TOUCHES, 4, 4))
# Nothing presses against the first touch.
GAPS[0] = 1.0


def feel(scene, rows=slice(None), contact=CONTACT, gaps=GAPS):
    """Return the readings of some touches, and the records by effect."""
    count = len(contact[rows])
    fields = RandomFields(0, [("touch", k) for k in range(TOUCHES)][rows])
    batch = TouchBatch(scene, gaps[rows], np.full(count, 1e-3), fields)
    readings, records = simulate(batch, contact[rows])
    return readings, {record.effect: record for record in records}


@pytest.mark.parametrize("effect", list(EFFECTS), ids=lambda effect: effect.name)
def test_an_effect_changes_what_calls_for_it_unless_it_is_switched_off(effect):
    scene = Scene(**effect.example)
    on, records = feel(scene)
    off, records_off = feel(with_modes(scene, **{effect.name: "never"}))
    assert records[effect.name].runs == records[effect.name].needed > 0
    assert records_off[effect.name].runs == 0
    assert not np.array_equal(on, off)
    assert ((on >= 0) & (on <= 1)).all()


@pytest.mark.parametrize("effect", list(EFFECTS), ids=lambda effect: effect.name)
def test_an_effect_that_is_not_needed_moves_no_bit_where_it_is_simulated_all_the_same(effect):
    for scene in (Scene(), Scene(**effect.example)):
        auto, records = feel(scene)
        always, _ = feel(with_modes(scene, **{effect.name: "always"}))
        np.testing.assert_array_equal(auto, always)
        if scene == Scene():
            assert records[effect.name].needed == 0


@pytest.mark.parametrize("effect", list(EFFECTS), ids=lambda effect: effect.name)
def test_an_effect_does_to_a_touch_what_it_does_to_it_among_others(effect):
    scene = Scene(**effect.example)
    together, _ = feel(scene)
    for k in range(TOUCHES):
        alone, _ = feel(scene, slice(k, k + 1))
        np.testing.assert_array_equal(alone[0], together[k])


def test_noise_has_its_deviation_and_a_sensors_dead_cells_read_nothing():
    even = np.full((TOUCHES, 64, 64), 0.5)
    noisy, _ = feel(Scene(noise=0.02), contact=even, gaps=0 * even)
    assert (noisy - even).std() == pytest.approx(0.02, rel=0.03)
    dead, _ = feel(Scene(dead_fraction=0.1), contact=even, gaps=0 * even)
    assert set(np.unique(dead)) == {0, 0.5}
    assert (dead == 0).mean() == pytest.approx(0.1, abs=0.02)
    np.testing.assert_array_equal(dead, np.broadcast_to(dead[:1], dead.shape))


def test_noise_stays_the_same_whatever_else_is_switched_on():
    def read(**scene):
        even = np.full((TOUCHES, 16, 16), 0.5)
        return feel(Scene(**scene), contact=even, gaps=0 * even)[0]

    others = {"gain_scatter": 0.02, "dead_fraction": 0.05, "drift_per_decade": 0.05}
    bare, rich = read(**others), read(noise=0.01, **others)
    inside = (bare > 0) & (rich > 0)
    assert inside.mean() > 0.9
    noise = read(noise=0.01) - read()
    np.testing.assert_allclose((rich - bare)[inside], noise[inside], atol=1e-12)


def test_every_mode_has_an_effect_and_every_effect_a_mode():
    _, records = feel(Scene())
    assert ["adaptive_size", *records] == list(TACTILE_EFFECTS)
