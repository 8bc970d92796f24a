import pytest

from visuohaptic.scene.parameters import PRESETS, Scene


@pytest.mark.parametrize("preset", sorted(PRESETS))
def test_a_preset_fills_what_is_not_given(preset):
    assert Scene() == Scene(preset="ideal")
    scene = Scene(preset=preset)
    for name, value in PRESETS[preset].items():
        assert getattr(scene, name) == value
    changed = Scene(preset=preset, noise=0.25, effects={"noise": "never"})
    assert changed.noise == 0.25
    assert changed.effects.noise == "never"
    assert changed.gain_scatter == scene.gain_scatter


@pytest.mark.parametrize("mode", ["auto", "always", "never"])
def test_one_mode_for_every_effect_leaves_the_rest_of_the_scene(mode):
    scene = Scene(preset="fsr400", effects={"noise": "always"})
    changed = scene.with_effects(mode)
    assert set(changed.effects.model_dump().values()) == {mode}
    assert changed.model_dump(exclude={"effects"}) == scene.model_dump(exclude={"effects"})
