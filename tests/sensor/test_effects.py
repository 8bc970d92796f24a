"""What holds of every effect of the sensor, by its entry alone."""

import numpy as np
import pytest
from sensor.scenes import with_modes

from visuohaptic.scene.parameters import TACTILE_EFFECTS, Scene
from visuohaptic.sensor import EFFECTS, RandomFields, Situation, simulate

TOUCHES = 3
CONTACT = np.random.default_rng(0).random((TOUCHES, 4, 4))
CONTACT[0] = 0.0
GAPS = 5e-4 * np.random.default_rng(1).random((TOUCHES, 4, 4))
# Nothing presses against the first touch.
GAPS[0] = 1.0


def feel(scene, rows=slice(None)):
    """Give the readings of some touches, and the records by effect."""
    count = len(CONTACT[rows])
    fields = RandomFields(0, [("touch", k) for k in range(TOUCHES)][rows])
    situation = Situation(scene, GAPS[rows], np.full(count, 1e-3), fields)
    readings, records = simulate(situation, CONTACT[rows])
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


def test_every_mode_has_an_effect_and_every_effect_a_mode():
    _, records = feel(Scene())
    assert ["adaptive_size", *records] == list(TACTILE_EFFECTS)
