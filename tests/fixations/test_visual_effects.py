import numpy as np
import pytest

from visuohaptic.fixations.visual_effects import plan_visual, seen_colours
from visuohaptic.scene.parameters import EffectModes

GREY = np.full((4, 3), 90, dtype=np.uint8)
PATTERN = np.array([[200, 10, 10], [10, 200, 10], [10, 10, 200], [90, 90, 90]], dtype=np.uint8)


@pytest.mark.parametrize(
    ("colours", "modes", "simulated"),
    [
        (GREY, {}, {"shading"}),
        (PATTERN, {}, {"colour", "texture", "shading"}),
        (GREY, {"colour": "always", "shading": "never"}, {"colour"}),
    ],
)
def test_an_object_calls_for_what_it_shows_and_modes_overrule_it(colours, modes, simulated):
    plans = plan_visual(EffectModes(**modes), colours, ambient=0.4).values()
    assert {plan.effect for plan in plans if plan.simulated} == simulated
    needed = {plan.effect for plan in plans if plan.needed} & {"colour", "texture"}
    assert needed == (set() if colours is GREY else {"colour", "texture"})


def test_colours_are_seen_as_they_are_unless_switched_off():
    areas = np.array([1.0, 1.0, 1.0, 5.0])
    np.testing.assert_array_equal(seen_colours(PATTERN, areas, EffectModes()), PATTERN)
    plain = seen_colours(PATTERN, areas, EffectModes(texture="never"))
    np.testing.assert_array_equal(plain, np.tile(plain[:1], (4, 1)))
    np.testing.assert_allclose(plain[0], (PATTERN * areas[:, None]).sum(axis=0) / 8, atol=0.5)
    grey = seen_colours(PATTERN, areas, EffectModes(colour="never"))
    assert (grey == grey[:, :1]).all()
    assert len(np.unique(grey[:, 0])) > 2
    for effect in ("colour", "texture"):
        found = seen_colours(GREY, areas, EffectModes(**{effect: "never"}))
        np.testing.assert_array_equal(found, GREY)
