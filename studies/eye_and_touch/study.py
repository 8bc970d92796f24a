"""Study `eye_and_touch`, and the names in its table."""

from __future__ import annotations

from visuohaptic.parameters import CostParameters
from visuohaptic.studies.study import WITHOUT_EFFECT, Step, Study

CLEAN = "clean"
"""Sight in which looking is trained."""

CUES = ("view", "outline")
"""Pictures that the eye describes: the grey view, and the silhouette of the object."""

LOOK = CUES[0]
"""Cue of looking that is combined with touch."""

TOUCH, PRODUCT, CHECKED, SIDE_BY_SIDE, STOPPING = (
    *("touch", "product", "checked product"),
    *("side by side", "stopping"),
)

PRICES = {"touch_seconds", "look_seconds", "budgets", "adaptive"}
"""Parameters of section `cost` that the study depends on."""

STUDY = Study(
    "eye_and_touch",
    "What the eye alone recognises, and what touch adds",
    steps=(
        Step(
            "eye_and_touch",
            "eye_and_touch.trials:make_eye_and_touch",
            ("results/eye_and_touch.parquet", "reports/eye_and_touch.json"),
            inputs=("meshes",),
            inputs_where={"cost.adaptive": "results/study_candidates.parquet"},
            needs={
                "exclude": {
                    **WITHOUT_EFFECT,
                    "cost": set(CostParameters.model_fields) - PRICES,
                }
            },
            is_alone=True,
        ),
    ),
    has_figures=False,
    kept="reports/eye_and_touch.json",
)
"""Accuracy by eye, by touch and by both, in good and in poor sight."""
