"""Study `effects`: the accuracy with every preset, and with every preset without one effect of the sensor."""

from __future__ import annotations

from collections.abc import Iterator

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.scene.parameters import PRESETS, Scene
from visuohaptic.studies.conditions import HEADLINE_CLASSIFIERS
from visuohaptic.studies.study import Condition, Step, Study


def effects_of(scene: Scene) -> tuple[str, ...]:
    """Return the names of the sensor's effects that a scene simulates."""
    is_simulated = {
        "adaptive_size": True,
        "elastic_cover": scene.cover != "none",
        "force_response": scene.break_pressure_pa > 0 or scene.saturation_pressure_pa is not None,
        "gain_scatter": scene.gain_scatter > 0,
        "hysteresis": scene.hysteresis > 0,
        "drift": scene.drift_per_decade != 0,
        "dead_cells": scene.dead_fraction > 0,
        "crosstalk": scene.readout != "ideal",
        "noise": scene.noise > 0,
        "quantisation": scene.bits is not None,
    }
    return tuple(name for name, simulated in is_simulated.items() if simulated)


def without_effect(preset: str, effect: str) -> str:
    """Return the name of the condition of a preset without an effect."""
    return f"{preset} without {effect}"


def effect_conditions(_run: ExperimentParameters) -> Iterator[Condition]:
    """Yield conditions of pipeline `paper`: every preset, and every preset without each of its effects."""
    for preset in PRESETS:
        changes = {
            "recognition.pipelines": ("paper",),
            "recognition.classifiers": (HEADLINE_CLASSIFIERS["paper"],),
            "scene.preset": preset,
        }
        yield Condition(preset, changes, compared_with=preset)
        for effect in effects_of(Scene.model_validate({"preset": preset})):
            without = {**changes, f"scene.effects.{effect}": "never"}
            yield Condition(without_effect(preset, effect), without, compared_with=preset)


EFFECTS_STUDY = Study(
    "effects", "How far effects of the sensor move the accuracy", effect_conditions
)

INFLUENCE = Study(
    "influence",
    "What effects cost, and how far they move images",
    steps=(
        Step(
            "effect_influence",
            "visuohaptic.studies.effects.influence:make_effect_influence",
            ("results/effect_influence.parquet",),
            inputs=("meshes", "fixations"),
            needs={
                "include": {
                    **dict.fromkeys(("seed", "viewpoints", "rendering", "sensor", "scene"), True),
                    "attention": {"fixations"},
                    "probing": {"unreachable", "when_exhausted"},
                }
            },
            objects="two",
        ),
    ),
    has_figures=False,
    is_part_of_run=True,
)
