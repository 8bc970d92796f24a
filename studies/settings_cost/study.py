"""Study `settings_cost`: settings whose accuracy and run time are compared; each family varies one parameter."""

from __future__ import annotations

from visuohaptic.parameters import ExperimentParameters
from visuohaptic.scene.parameters import PRESETS
from visuohaptic.studies.cost.settings import (
    CUES,
    Families,
    Setting,
    cost_study,
    counted,
    make_settings,
)

CLASSIC_CHANNELS = ("colour", "intensity", "orientation")
"""The channels of Itti, Koch and Niebur (1998)."""


def families_of(run: ExperimentParameters) -> Families:
    """Return the families of settings; each varies one parameter over its range."""
    cost, weights = run.cost, run.attention.weights.model_dump()
    used = [name for name, weight in weights.items() if weight]
    classic, own = (
        {name: (weight or 1.0) if name in channels else 0.0 for name, weight in weights.items()}
        for channels in (CLASSIC_CHANNELS, used)
    )
    lean = {"rendering.resolution": cost.lean_view_resolution, "attention.weights": classic}
    views = {counted(count, "viewpoint"): {"viewpoints": count} for count in cost.viewpoints}
    classifiers = {
        "paper": run.recognition.classifiers,
        "order_free": run.recognition.order_free.classifiers,
    }
    return {
        "touches": {counted(count, "touch", "es"): {"touches": count} for count in cost.touches},
        "viewpoints": views,
        "lean_viewpoints": {name: values | lean for name, values in views.items()},
        "imprint": {f"{n} × {n}": {"sensor.resolution": n} for n in cost.imprint_resolutions},
        "render": {f"{n} × {n}": {"rendering.resolution": n} for n in cost.view_resolutions},
        "channels": {
            f"{len(CLASSIC_CHANNELS)} channels": {"attention.weights": classic},
            f"{len(used)} channels": {"attention.weights": own},
        },
        "features": {**CUES, "skin and pose": {}},
        "pipelines": {
            f"{pipeline}, {name.replace('_', ' ')}": {"pipeline": pipeline, "classifier": name}
            for pipeline, names in classifiers.items()
            for name in names
        },
        "effects": {preset: {"scene.preset": preset} for preset in PRESETS},
    }


def settings_of(run: ExperimentParameters) -> list[Setting]:
    """Return all settings, family by family."""
    return make_settings(run, families_of(run))


STUDY = cost_study(
    "settings_cost",
    "What accuracy costs in time, setting by setting",
    settings_of,
    ("settings_cost.costs:make_seconds", "settings_cost.costs:make_costs"),
)
