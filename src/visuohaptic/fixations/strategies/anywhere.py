"""Random places, uniform over the surface by area."""

from __future__ import annotations

import numpy as np

from visuohaptic.attention.parameters import AttentionParameters
from visuohaptic.fixations.attended_views import Viewpoint
from visuohaptic.fixations.places import ProbingLocations, draw_by_area, face_outwards


def choose(
    one: Viewpoint, attention: AttentionParameters, generator: np.random.Generator
) -> ProbingLocations:
    """Draw places over the whole surface, hidden parts too."""
    drawn = draw_by_area(one.caster.surface, attention.fixations, generator)
    return face_outwards(one.caster, drawn)
