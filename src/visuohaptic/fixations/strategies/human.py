"""Where people are predicted to look."""

from __future__ import annotations

import numpy as np

from visuohaptic.attention.model import attend
from visuohaptic.attention.parameters import AttentionParameters, read_fitted_weights
from visuohaptic.attention.scanpath import Scanpath
from visuohaptic.fixations.attended_views import AttendedView


def choose(one: AttendedView, attention: AttentionParameters, *_: object) -> Scanpath:
    """Let the eye follow channels and terms by the weights that were fitted to people's gaze."""
    fitted = AttentionParameters.model_validate({"weights": "human_channels"}).weights
    (found,) = attend(
        **one.seen.arrays(slice(one.place, one.place + 1)),
        parameters=attention.model_copy(update={"weights": fitted}),
        eye=np.array([one.camera.eye]),
        terms=read_fitted_weights()["terms"],
    )
    return found.scanpath
