"""Strategy `human`: fixations by a model of people's gaze."""

from __future__ import annotations

import numpy as np

from visuohaptic.attention.model import attend
from visuohaptic.attention.parameters import AttentionParameters, read_fitted_weights
from visuohaptic.attention.scanpath import Scanpath
from visuohaptic.fixations.attended_views import AttendedView


def choose(view: AttendedView, attention: AttentionParameters, *_: object) -> Scanpath:
    """Choose fixations with the weights of channels and terms that were fitted to people's gaze."""
    fitted = AttentionParameters.model_validate({"weights": "human_channels"}).weights
    (attended,) = attend(
        **view.views.attend_arguments(slice(view.index, view.index + 1)),
        parameters=attention.model_copy(update={"weights": fitted}),
        eye=np.array([view.camera.eye]),
        terms=read_fitted_weights()["terms"],
    )
    return attended.scanpath
