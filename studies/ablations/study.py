"""Study `ablations`: leave out or replace one part of the method at a time."""

from __future__ import annotations

from collections.abc import Iterator

from visuohaptic.attention.registry import CHANNELS
from visuohaptic.features.descriptors import DESCRIPTORS
from visuohaptic.parameters import ExperimentParameters
from visuohaptic.scene.parameters import PRESETS
from visuohaptic.studies.conditions import FIXATION_ONLY
from visuohaptic.studies.study import Changes, Condition, Study

WHOLE = "whole_method"

_SKIN = ("contourlet", "imprint", "sensor")
_POSE = ("pose", "relations", "embedding")
_ONE_DESCRIPTOR: Changes = {"recognition.order_free.cues": ("contourlet", "sensor", *_POSE)}

_VERTICAL: Changes = {
    "recognition.frame": "vertical",
    "recognition.pipelines": ("order_free",),
}

OTHER_DESCRIPTORS = tuple(entry for entry in DESCRIPTORS if entry.name != "contourlet")
"""Descriptors that replace the contourlet transform of an imprint."""

PARTS: dict[str, Changes] = {
    WHOLE: {},
    "cutaneous_only": {"recognition.cues": ("cutaneous",), "recognition.order_free.cues": _SKIN},
    "kinesthetic_only": {
        "recognition.cues": ("kinesthetic",),
        "recognition.order_free.cues": _POSE,
    },
    "contourlet_only": _ONE_DESCRIPTOR,
    **{
        entry.name: {"features.descriptor": entry.name, **_ONE_DESCRIPTOR}
        for entry in OTHER_DESCRIPTORS
    },
    "fixed_sensor_size": {"scene.effects.adaptive_size": "never"},
    "without_map": {
        "recognition.self_organising_map.output": "none",
        "recognition.pipelines": ("paper",),
    },
    "turned_upright": {"meshes.turns": "vertical"},
    "turned_any_way": {"meshes.turns": "any"},
    "vertical_frame": _VERTICAL,
    "vertical_frame_turned_upright": {**_VERTICAL, "meshes.turns": "vertical"},
    **{preset: {"scene.preset": preset} for preset in PRESETS},
    **{f"without_{channel}": {f"attention.weights.{channel}": 0.0} for channel in CHANNELS},
}
"""Changed parameters of each ablation; the whole method comes first."""


def ablated(run: ExperimentParameters) -> Iterator[Condition]:
    """Yield the ablations whose pipelines the run has."""
    for name, changes in PARTS.items():
        if set(changes.get("recognition.pipelines", ())) <= set(run.recognition.pipelines):
            yield Condition(name, {**FIXATION_ONLY, **changes})


STUDY = Study("ablations", "Ablations", ablated)
