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
    (found,) = attend(
        **one.seen.arrays(slice(one.place, one.place + 1)),
        parameters=attention.model_copy(update={"weights": human.weights, "terms": human.terms}),
        eye=np.array([one.camera.eye]),
    )
    return found.scanpath
