"""Where people are predicted to look."""

from __future__ import annotations

import numpy as np

from visuohaptic.attention.model import attend
from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.attention.scanpath import Scanpath
from visuohaptic.fixations.looking import Look


def choose(one: Look, attention: AttentionParameters, *_: object) -> Scanpath:
    """Let the eye follow channels and terms by the weights that were fitted to people's gaze."""
    human = AttentionParameters.model_validate({"weights": "human"})
    part = slice(one.place, one.place + 1)
    seen = one.seen
    (found,) = attend(
        seen.colour[part],
        seen.mask[part],
        seen.point[part],
        seen.normal[part],
        seen.face[part],
        seen.curvature[part],
        attention.model_copy(update={"weights": human.weights, "terms": human.terms}),
        np.array([one.camera.eye]),
    )
    return found.scanpath
