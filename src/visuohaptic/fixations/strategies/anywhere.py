"""Random places, uniform over the surface by area."""

from __future__ import annotations

import numpy as np

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.fixations.looking import Standpoint
from visuohaptic.fixations.places import ProbingLocations, draw_by_area, face_outwards


def choose(
    one: Standpoint, attention: AttentionParameters, generator: np.random.Generator
) -> ProbingLocations:
    """Draw places over the whole surface, hidden parts too."""
    drawn = draw_by_area(one.caster.surface, attention.fixations, generator)
    return face_outwards(one.caster, drawn)
