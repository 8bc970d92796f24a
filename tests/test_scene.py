import numpy as np
import pytest
from pydantic import ValidationError

from visuohaptic.errors import RegistryError
from visuohaptic.scene import PRESETS, VISUAL_EFFECTS, EffectModes, Scene, plan_visual, seen_colours

GREY = np.full((4, 3), 90, dtype=np.uint8)
PATTERN = np.array([[200, 10, 10], [10, 200, 10], [10, 10, 200], [90, 90, 90]], dtype=np.uint8)


def test_the_default_scene_is_ideal_and_calls_for_nothing():
    scene = Scene()
    assert scene == Scene(preset="ideal")
    assert (scene.cover, scene.readout, scene.bits, scene.noise) == ("none", "ideal", None, 0)


@pytest.mark.parametrize("preset", sorted(PRESETS))
def test_a_preset_fills_what_is_not_given(preset):
    scene = Scene(preset=preset)
    for name, value in PRESETS[preset].items():
        assert getattr(scene, name) == value
    changed = Scene(preset=preset, noise=0.25, effects={"noise": "never"})
    assert changed.noise == 0.25
    assert changed.effects.noise == "never"
    assert changed.gain_scatter == scene.gain_scatter


def test_a_dumped_scene_reads_back_as_itself():
    scene = Scene(preset="worn_fsr", bits=10, effects={"drift": "always"})
    assert Scene.model_validate(scene.model_dump()) == scene


@pytest.mark.parametrize("mode", ["auto", "always", "never"])
def test_one_mode_for_every_effect_leaves_the_rest_of_the_scene(mode):
    scene = Scene(preset="fsr400", effects={"noise": "always"})
    changed = scene.with_effects(mode)
    assert set(changed.effects.model_dump().values()) == {mode}
    assert changed.model_dump(exclude={"effects"}) == scene.model_dump(exclude={"effects"})


def test_a_worn_sensor_differs_from_a_new_one():
    assert Scene(preset="worn_fsr").dead_fraction > Scene(preset="fsr400").dead_fraction == 0


@pytest.mark.parametrize(
    "wrong",
    [
        {"preset": "fsr9000"},
        {"press_depths_m": []},
        {"noise": -0.1},
        {"bits": 0},
        {"effects": {"noise": "sometimes"}},
        {"nosie": 0.1},
    ],
)
def test_values_that_make_no_sense_are_refused(wrong):
    with pytest.raises(ValidationError):
        Scene(**wrong)


def test_an_effect_of_the_view_without_a_plan_is_refused(monkeypatch):
    monkeypatch.setattr("visuohaptic.scene.VISUAL_EFFECTS", (*VISUAL_EFFECTS, "fog"))
    with pytest.raises(RegistryError, match=r"each of colour, .*, fog needs a plan"):
        visual(GREY)


def visual(face_colours, ambient=0.4, **modes):
    return {plan.effect: plan for plan in plan_visual(EffectModes(**modes), face_colours, ambient)}


def test_a_grey_object_calls_for_no_colour_and_a_uniform_one_for_no_texture():
    plans = visual(GREY)
    assert not plans["colour"].called_for
    assert not plans["texture"].called_for
    plans = visual(PATTERN)
    assert plans["colour"].simulated
    assert plans["texture"].simulated


def test_even_light_calls_for_neither_shading_nor_shadows():
    plans = visual(GREY, ambient=1.0)
    assert not plans["shading"].called_for
    assert not plans["cast_shadows"].called_for
    assert plans["cast_shadows"].reason == "all light is ambient"


def test_without_shading_there_are_no_shadows():
    plans = visual(GREY, shading="never")
    assert not plans["cast_shadows"].simulated
    assert plans["cast_shadows"].reason == "without shading no light is blocked"


def test_modes_overrule_what_is_called_for():
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
def test_switching_off_what_is_not_called_for_changes_nothing(effect):
    modes = EffectModes(**{effect: "never"})
    np.testing.assert_array_equal(seen_colours(GREY, np.arange(1.0, 5.0), modes), GREY)
