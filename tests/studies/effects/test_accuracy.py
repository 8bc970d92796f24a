"""Every preset is measured whole, and without each effect that it gives strength to."""

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.scene.parameters import VISUAL_EFFECTS, EffectModes, Scene
from visuohaptic.studies.conditions import plan_study
from visuohaptic.studies.effects.accuracy import EFFECTS_STUDY, effects_of, without_effect

RUN = ExperimentParameters()


def test_every_effect_of_the_sensor_is_one_that_a_scene_can_give_strength_to():
    strong = Scene(
        cover="winkler", break_pressure_pa=1, gain_scatter=0.1, hysteresis=0.1, drift_per_decade=0.1,
        dead_fraction=0.1, readout="grounded", noise=0.1, bits=8,
    )  # fmt: skip
    assert set(effects_of(strong)) == set(EffectModes.model_fields) - set(VISUAL_EFFECTS)
    assert effects_of(Scene()) == ("adaptive_size",)


def test_each_scene_without_an_effect_is_compared_with_the_whole_scene():
    plan = plan_study(EFFECTS_STUDY, RUN)
    found = {one.condition.name: one for one in plan.conditions}
    without = found[without_effect("worn_fsr", "noise")]
    assert without.condition.compared_with == "worn_fsr"
    modes = without.parameters.scene.effects.model_copy(update={"noise": "auto"})
    whole = without.parameters.scene.model_copy(update={"effects": modes})
    assert (
        whole == found["worn_fsr"].parameters.scene == Scene.model_validate({"preset": "worn_fsr"})
    )
    assert {recomputation.phase for recomputation in plan.recomputations.values()} == {"touches"}
