import numpy as np
import pytest

from visuohaptic.fixations.visual_effects import plan_visual, seen_colours
from visuohaptic.scene.parameters import EffectModes

GREY = np.full((4, 3), 90, dtype=np.uint8)
PATTERN = np.array([[200, 10, 10], [10, 200, 10], [10, 10, 200], [90, 90, 90]], dtype=np.uint8)


def visual(face_colours, ambient=0.4, **modes):
    return {plan.effect: plan for plan in plan_visual(EffectModes(**modes), face_colours, ambient)}


def test_a_grey_object_calls_for_no_colour_and_a_uniform_one_for_no_texture():
    plans = visual(GREY)
    assert not plans["colour"].needed
    assert not plans["texture"].needed
    plans = visual(PATTERN)
    assert plans["colour"].simulated
    assert plans["texture"].simulated


def test_modes_overrule_what_is_needed():
    plans = visual(GREY, colour="always", shading="never")
    assert plans["colour"].simulated
    assert not plans["shading"].simulated


def test_colours_are_seen_as_they_are_unless_switched_off():
    areas = np.array([1.0, 1.0, 1.0, 5.0])
    np.testing.assert_array_equal(seen_colours(PATTERN, areas, EffectModes()), PATTERN)
    plain = seen_colours(PATTERN, areas, EffectModes(texture="never"))
    np.testing.assert_array_equal(plain, np.tile(plain[:1], (4, 1)))
    np.testing.assert_allclose(plain[0], (PATTERN * areas[:, None]).sum(axis=0) / 8, atol=0.5)
    grey = seen_colours(PATTERN, areas, EffectModes(colour="never"))
    assert (grey == grey[:, :1]).all()
    assert len(np.unique(grey[:, 0])) > 2


@pytest.mark.parametrize("effect", ["colour", "texture"])
def test_switching_off_what_is_not_needed_changes_nothing(effect):
    modes = EffectModes(**{effect: "never"})
    np.testing.assert_array_equal(seen_colours(GREY, np.arange(1.0, 5.0), modes), GREY)
